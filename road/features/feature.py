"""Road features by kind: those of foreride, and those of installed packages and users (`FEATURES`)."""

from typing import Annotated, get_args

from foreride.files.plugins import Registry, tagged_class
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
from foreride.road.features.model import RoadFeature
from foreride.road.features.pothole import Pothole

__all__ = [
    "FEATURES",
    "PAINTS",
    "Bump",
    "ExpansionJoint",
    "Feature",
    "Fitting",
    "FlatTopHump",
    "HalfSineBump",
    "ManholeCover",
    "Pothole",
    "RoadFeature",
    "SinusoidalHump",
    "SpeedCushion",
    "Step",
    "TrapezoidalBump",
    "WattsHump",
]

_OWN: tuple[type[RoadFeature], ...] = get_args(Bump | Pothole | Fitting)
FEATURES: Registry[type[RoadFeature]] = Registry(
    "foreride.features", "feature", {cls.kind: cls for cls in _OWN}, tagged_class(RoadFeature)
)
Feature = Annotated[RoadFeature, FEATURES]
"""A feature, read from YAML by its `kind`."""
