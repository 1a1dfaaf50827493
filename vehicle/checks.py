"""Range checks of scalar parameters."""

import math
from typing import Any

from files.errors import InputError


def require(name: str, value: Any, above: float | None = None, least: float | None = None) -> None:
    """Raise InputError unless `value` is a finite number > `above`, or >= `least`."""
    ok = isinstance(value, int | float) and math.isfinite(value)
    if above is not None and not (ok and value > above):
        raise InputError(f"{name} must be > {above:g} and finite, got {value}")
    if least is not None and not (ok and value >= least):
        raise InputError(f"{name} must be >= {least:g} and finite, got {value}")
