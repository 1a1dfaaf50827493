"""Study axes: the variation of one scenario field."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from annotated_types import Interval

from foreride.files.errors import InputError, shown
from foreride.files.reading import strict
from foreride.files.reading.ranges import Checked

Finite = Annotated[float, Interval(ge=-1e12, le=1e12), "the field's own unit"]
Spread = Annotated[float, Interval(ge=0.0, le=1e12), "the field's own unit"]
Scalar = bool | int | float | str
_RANGE_KEYS = ({"low", "high"}, {"mean", "sigma"})


@dataclass(frozen=True)
class Axis(Checked):
    """Variation of one field: a list of values, a uniform range or a normal distribution.

    scale `log` makes the range low ... high uniform in the logarithm; `whole` rounds to integers.
    """

    values: tuple[Scalar, ...] = ()
    low: Finite = 0.0
    high: Finite = 0.0
    mean: Finite = 0.0
    sigma: Spread = 0.0
    scale: Literal["linear", "log"] = "linear"
    whole: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.values:
            return
        if self.sigma == 0 and not self.low < self.high:
            raise InputError(f"low must be < high (or sigma > 0), got low {self.low:g}, high {self.high:g}")
        if self.scale == "log" and not 0 < self.low < self.high:
            raise InputError(f"low must be > 0 on a log scale, got {self.low:g}")

    def quantile(self, probability: float) -> Scalar:
        """Quantile of the axis's distribution at `probability`, 0 ... 1."""
        if self.values:
            return self.values[min(int(probability * len(self.values)), len(self.values) - 1)]
        if self.sigma > 0:
            from scipy.special import ndtri  # the normal quantile

            value = self.mean + self.sigma * float(ndtri(min(max(probability, 1e-12), 1 - 1e-12)))
        elif self.scale == "log":
            value = float(self.low * (self.high / self.low) ** probability)
        else:
            value = self.low + (self.high - self.low) * probability
        return round(value) if self.whole else value


def read_axis(definition: Any, location: str) -> Axis:
    """Parse the axis that a study file gives at `location`; InputError for an invalid one."""
    if isinstance(definition, list):
        definition = {"values": definition}
    message = f"{location} must give values, or low and high, or mean and sigma, got {shown(definition)}"
    if not isinstance(definition, dict):
        raise InputError(message)
    range_fields = {name: value for name, value in definition.items() if name != "values"}
    if "values" in definition:
        values = definition["values"]
        if range_fields or not isinstance(values, list) or not values:
            raise InputError(f"{location}.values must be a list and stand alone, got {shown(definition)}")
        return Axis(tuple(scalar(value, f"{location}.values") for value in values))
    if not any(keys <= set(range_fields) for keys in _RANGE_KEYS) or {"low", "mean"} <= set(range_fields):
        raise InputError(message)
    axis = strict.structure(Axis, range_fields, location)
    assert isinstance(axis, Axis)
    return axis


def scalar(value: Any, location: str) -> Scalar:
    """Return the value; InputError unless it is a scalar that a field may be set to."""
    if not isinstance(value, bool | int | float | str):
        raise InputError(f"{location} must hold numbers, texts, true or false, got {shown(value)}")
    return value
