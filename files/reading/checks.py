"""Range checks shared by the dataclasses of this package."""

import math

from foreride.files.errors import InputError


def check_number(name: str, value: object, low: float, high: float, *, open_low: bool = False) -> None:
    """Raise InputError unless `value` is a finite real number in [low, high] ((low, high] if `open_low`)."""
    bound = f"{'>' if open_low else '>='} {low:g}" if math.isfinite(low) else ""
    bound += f" and <= {high:g}" if bound and math.isfinite(high) else ""
    bound = bound or (f"<= {high:g}" if math.isfinite(high) else "a finite number")
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise InputError(f"{name} must be a finite number, {bound}, got {value!r}")
    if value > high or value < low or (open_low and value == low):
        raise InputError(f"{name} must be {bound}, got {value!r}")


def check_choice(name: str, value: object, allowed: tuple[str, ...]) -> None:
    """Raise InputError unless `value` is one of `allowed`."""
    if value not in allowed:
        raise InputError(f"{name} must be one of {', '.join(allowed)}, got {value!r}")
