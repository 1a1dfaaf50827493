"""Ride comfort: ISO 2631-1 frequency weighting, vibration measures and the ride metrics built on them."""

from foreride.comfort.measures import (
    COMFORT_BANDS,
    comfort_bands,
    crest_factor,
    evdv,
    msdv,
    mtvv,
    running_rms,
    vdv,
    weighted_rms,
)
from foreride.comfort.metrics import ride_metrics
from foreride.comfort.occupant import SeatedPerson, acceleration_at, axis_values, body_motion, total_value
from foreride.comfort.registry import METRICS, Column, Metric, Tolerance
from foreride.comfort.weighting import WEIGHTINGS, frequency_weighting, weight, wk_second_order

__all__ = [
    "COMFORT_BANDS",
    "METRICS",
    "WEIGHTINGS",
    "Column",
    "Metric",
    "SeatedPerson",
    "Tolerance",
    "acceleration_at",
    "axis_values",
    "body_motion",
    "comfort_bands",
    "crest_factor",
    "evdv",
    "frequency_weighting",
    "msdv",
    "mtvv",
    "ride_metrics",
    "running_rms",
    "total_value",
    "vdv",
    "weight",
    "weighted_rms",
    "wk_second_order",
]
