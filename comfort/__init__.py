"""What a ride feels like, in numbers: ISO 2631-1 frequency weighting and the metrics built on it."""

from comfort.metrics import ride_metrics
from comfort.weighting import (
    crest_factor,
    frequency_weighting,
    mtvv,
    running_rms,
    vdv,
    weight,
    weighted_rms,
    wk_second_order,
)

__all__ = [
    "crest_factor",
    "frequency_weighting",
    "mtvv",
    "ride_metrics",
    "running_rms",
    "vdv",
    "weight",
    "weighted_rms",
    "wk_second_order",
]
