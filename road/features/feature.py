"""Discrete road obstacles (features), by kind.

A feature adds its `height(x, y)` to the road: positive for bumps and humps, negative for potholes, zero
outside its `footprint(x, y)` (except a step, which persists). `start_m` is the near edge, the first x at
which the height departs from zero, `end_m` the far edge. `cls` is the detector class: 0 speed bump, 1
pothole, None for all others.
"""

from foreride.road.features.bumps import (
    PAINTS,
    Bump,
    FlatTopHump,
    HalfSineBump,
    SinusoidalHump,
    SpeedCushion,
    TrapezoidalBump,
    WattsHump,
)
from foreride.road.features.joints_and_covers import ExpansionJoint, Fitting, ManholeCover, Step
from foreride.road.features.pothole import Pothole

__all__ = [
    "FEATURE_KINDS",
    "PAINTS",
    "Bump",
    "ExpansionJoint",
    "Feature",
    "Fitting",
    "FlatTopHump",
    "HalfSineBump",
    "ManholeCover",
    "Pothole",
    "SinusoidalHump",
    "SpeedCushion",
    "Step",
    "TrapezoidalBump",
    "WattsHump",
]

Feature = Bump | Pothole | Fitting
FEATURE_KINDS: dict[str, type[Feature]] = {feature.kind: feature for feature in Feature.__args__}
