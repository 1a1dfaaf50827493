"""Preview suspension in closed loop: camera, detector, road preview, damper controller, car, ride comfort."""

from pathlib import Path

_CHECKOUT = Path(__file__).resolve().parents[1]
if (_CHECKOUT / "pyproject.toml").is_file() and (_CHECKOUT / "road").is_dir():
    # A wheel holds the packages inside this folder; in a checkout they stand beside it.
    __path__.append(str(_CHECKOUT))
