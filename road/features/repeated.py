"""Repeated features: copies of one feature along the road, in either wheel track or in both."""

from dataclasses import dataclass, fields, replace
from typing import Annotated, Any, Literal

from annotated_types import Interval

from foreride.files.errors import InputError
from foreride.files.reading.ranges import Checked
from foreride.road.features.feature import Feature, ManholeCover, Pothole, RoadFeature, SpeedCushion

Placement = Literal["left", "right", "both"]


@dataclass(frozen=True)
class Chain(Checked):
    """Repetition of a feature: `count` copies, `spacing_m` from start to start.

    Args:
        feature: the first copy, placed as it says unless `tracks` says otherwise.
        tracks: wheel tracks of the copies, in turn ("left", "right" or "both", at y = +-track_m / 2).
            Potholes, covers and cushions are centred there, "both" makes two of one; all else is cut to that
            half of the road, "both" leaves it whole. Empty: all as the feature says.

    Each copy of a pothole has a rim of its own, from the feature's seed and its number.
    """

    feature: Feature
    count: Annotated[int, Interval(ge=1, le=10_000), "copies"] = 1
    spacing_m: Annotated[float, Interval(ge=0.0, le=10_000.0), "m"] = 0.0
    tracks: tuple[Placement, ...] = ()
    track_m: Annotated[float, Interval(ge=0.5, le=4.0), "m"] = 1.5

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.count > 1 and self.spacing_m == 0:
            raise InputError(f"spacing_m must be > 0 for count = {self.count}, got {self.spacing_m!r}")

    def features(self) -> tuple[RoadFeature, ...]:
        """All copies, ordered by position."""
        copies: list[RoadFeature] = []
        for number in range(self.count):
            copy = _changed(self.feature, start_m=self.feature.start_m + number * self.spacing_m)
            for placed in self._placed(copy, self.tracks[number % len(self.tracks)] if self.tracks else None):
                if isinstance(placed, Pothole):
                    placed = replace(placed, seed=placed.seed + len(copies))
                copies.append(placed)
        return tuple(copies)

    def _placed(self, feature: RoadFeature, track: Placement | None) -> list[RoadFeature]:
        if track is None:
            return [feature]
        sides = {"left": [1], "right": [-1], "both": [1, -1]}[track]
        if isinstance(feature, Pothole | ManholeCover):
            return [replace(feature, y_m=side * self.track_m / 2) for side in sides]
        if isinstance(feature, SpeedCushion):
            half = (feature.y_max_m - feature.y_min_m) / 2
            middles = [side * self.track_m / 2 for side in sides]
            return [replace(feature, y_min_m=y - half, y_max_m=y + half) for y in middles]
        if track == "both":
            return [feature]
        if not {"y_min_m", "y_max_m"} <= {field.name for field in fields(feature)}:
            raise InputError(f"tracks: a {feature.kind} cannot be placed in a track; leave out tracks")
        if feature.y_min_m >= 0 or feature.y_max_m <= 0:
            raise InputError(
                f"tracks: {track} cuts the feature at y = 0, but it spans {feature.y_min_m:g} to "
                f"{feature.y_max_m:g} m"
            )
        return [_changed(feature, y_min_m=0.0) if track == "left" else _changed(feature, y_max_m=0.0)]


def _changed(feature: RoadFeature, **values: Any) -> RoadFeature:
    return replace(feature, **values)
