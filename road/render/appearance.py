"""Visual appearance of a road: surface, markings, light, weather and camera artefacts; no geometry."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Interval

from foreride.files.errors import InputError
from foreride.files.reading.checks import check_choice
from foreride.files.reading.ranges import Checked, Share

LIGHTS = ("noon", "overcast", "sunset", "night")
WEATHERS = ("dry", "wet", "rain", "fog", "snow")
SURFACES = ("asphalt", "old_asphalt", "concrete")
VERGES = ("grass", "soil", "pavement", "red_soil", "dry_grass", "gravel")
CENTRE_LINES = ("none", "dashed", "solid", "double")
LINE_COLOURS = ("white", "yellow")
SURROUNDINGS = ("town", "country", "avenue")

_CHOICES = {
    "light": LIGHTS,
    "weather": WEATHERS,
    "surface": SURFACES,
    "verge": VERGES,
    "centre_line": CENTRE_LINES,
    "line_colour": LINE_COLOURS,
    "surroundings": SURROUNDINGS,
}


@dataclass(frozen=True)
class Appearance(Checked):
    """Visual parameters of a scene: surface, light, weather, camera artefacts.

    Azimuth is measured from straight ahead, positive left (ISO 8855). `brightness` is the albedo of the
    carriageway; `wear`, `cracks`, `patches`, `distractors` and `tree_shadow` are densities in 0..1;
    `bonnet` is the share of the image height that the bonnet hides at the image centre; `exposure`
    multiplies the scene's own exposure; `warmth` shifts the white balance from blue (-) to red (+);
    `noise` is the noise of a bright pixel as a share of full scale. `paint_wear` wears the paint of bumps
    beyond `wear`; `decay` crumbles potholes and fills some with mud, gravel or water; `dirt`, `litter` and
    `puddles` are densities of loose material and water on the road; `street_lamps` is their brightness at
    night; `glare` is the glare of a low sun in the image; `motion_blur_px` is the distance that a point at
    the lower edge of the image travels during the exposure; `distortion` is the radial coefficient of the
    lens, negative for barrel distortion; `fatigue` is the density of alligator cracking, around potholes
    and elsewhere; `arrows` is the density of arrows on the lanes; `delamination` is the share of the shallow
    potholes that are lost top layers, `flooding` that of all potholes under water. Fields from `paint_wear`
    on are 0 by default. Raises InputError for values out of range.
    """

    light: str = "overcast"
    weather: str = "dry"
    surface: str = "asphalt"
    verge: str = "grass"
    left_edge_m: Annotated[float, Interval(ge=1.5, le=6.5), "m"] = 3.8
    right_edge_m: Annotated[float, Interval(ge=-6.5, le=-1.5), "m"] = -3.8
    edge_lines: bool = True
    centre_line: str = "none"
    line_colour: str = "white"
    brightness: Annotated[float, Interval(ge=0.05, le=0.6), "1"] = 0.2
    wear: Share = 0.3
    cracks: Share = 0.3
    patches: Share = 0.3
    distractors: Share = 0.2
    sun_azimuth_deg: Annotated[float, Interval(ge=-180.0, le=180.0), "degrees"] = 60.0
    sun_elevation_deg: Annotated[float, Interval(ge=3.0, le=90.0), "degrees"] = 50.0
    tree_shadow: Share = 0.0
    bonnet: Annotated[float, Interval(ge=0.0, le=0.25), "1"] = 0.0
    exposure: Annotated[float, Interval(ge=0.3, le=3.0), "1"] = 1.0
    warmth: Annotated[float, Interval(ge=-0.2, le=0.2), "1"] = 0.0
    noise: Annotated[float, Interval(ge=0.0, le=0.05), "1"] = 0.008
    blur_px: Annotated[float, Interval(ge=0.0, le=2.0), "px"] = 0.5
    surroundings: str = "town"
    paint_wear: Share = 0.0
    decay: Share = 0.0
    dirt: Share = 0.0
    litter: Share = 0.0
    puddles: Share = 0.0
    street_lamps: Share = 0.0
    glare: Share = 0.0
    motion_blur_px: Annotated[float, Interval(ge=0.0, le=12.0), "px"] = 0.0
    distortion: Annotated[float, Interval(ge=-0.15, le=0.1), "1"] = 0.0
    fatigue: Share = 0.0
    arrows: Share = 0.0
    delamination: Share = 0.0
    flooding: Share = 0.0

    def __post_init__(self) -> None:
        for name, allowed in _CHOICES.items():
            check_choice(name, getattr(self, name), allowed)
        super().__post_init__()
        if not isinstance(self.edge_lines, bool):
            raise InputError(f"edge_lines must be true or false, got {self.edge_lines!r}")


def random_appearance(rng: np.random.Generator) -> Appearance:
    """Random appearance as varied as real roads; every field is drawn, in a fixed order."""
    light = str(rng.choice(LIGHTS, p=(0.4, 0.31, 0.14, 0.15)))
    surface = str(rng.choice(SURFACES, p=(0.45, 0.42, 0.13)))
    low, high = {"asphalt": (0.07, 0.18), "old_asphalt": (0.14, 0.3), "concrete": (0.28, 0.42)}[surface]
    left, right = _random_edges(rng)
    sun_in_image = light == "sunset" and rng.random() < 0.6  # the sun is in the image
    return Appearance(
        light=light,
        weather=str(rng.choice(WEATHERS, p=(0.68, 0.09, 0.1, 0.06, 0.07))),
        surface=surface,
        verge=str(rng.choice(VERGES, p=(0.25, 0.12, 0.28, 0.13, 0.12, 0.1))),
        left_edge_m=left,
        right_edge_m=right,
        edge_lines=bool(rng.random() < 0.5),
        centre_line=str(rng.choice(CENTRE_LINES, p=(0.35, 0.35, 0.15, 0.15))),
        line_colour=str(rng.choice(LINE_COLOURS, p=(0.65, 0.35))),
        brightness=float(rng.uniform(low, high)),
        wear=float(rng.uniform(0, 1)),
        cracks=float(rng.beta(1.2, 2)),
        patches=float(rng.beta(1.2, 2)),
        distractors=float(rng.beta(1.2, 2)),
        sun_azimuth_deg=float(rng.uniform(-35, 35) if sun_in_image else rng.uniform(-180, 180)),
        sun_elevation_deg=float(rng.uniform(4, 18) if light == "sunset" else rng.uniform(25, 75)),
        tree_shadow=_uniform_or_zero(rng, 0.3, 0.2, 1),
        bonnet=_uniform_or_zero(rng, 0.25, 0.03, 0.16),
        exposure=float(np.clip(np.exp(rng.normal(0, 0.28)), 0.45, 2.2)),
        warmth=float(np.clip(rng.normal(0, 0.05), -0.15, 0.15)),
        noise=float(rng.uniform(0.002, 0.02)),
        blur_px=float(rng.uniform(0.3, 0.9)),
        surroundings=str(rng.choice(SURROUNDINGS, p=(0.3, 0.35, 0.35))),
        paint_wear=_uniform_or_zero(rng, 0.55, 0.1, 1),
        decay=float(rng.uniform(0.1, 1)),
        dirt=_uniform_or_zero(rng, 0.5, 0.1, 1),
        litter=_uniform_or_zero(rng, 0.4, 0.1, 1),
        puddles=_uniform_or_zero(rng, 0.15, 0.2, 1),
        street_lamps=_uniform_or_zero(rng, 0.6, 0.3, 1) if light == "night" else 0.0,
        glare=_uniform_or_zero(rng, 0.8, 0.3, 1) if sun_in_image else 0.0,
        motion_blur_px=_uniform_or_zero(rng, 0.3, 1.5, 9),
        distortion=_uniform_or_zero(rng, 0.4, -0.12, 0.04),
    )


def _uniform_or_zero(rng: np.random.Generator, share: float, low: float, high: float) -> float:
    """A uniform number between `low` and `high` with probability `share`, otherwise 0."""
    return float(rng.uniform(low, high) if rng.random() < share else 0.0)


def _random_edges(rng: np.random.Generator) -> tuple[float, float]:
    """Edges (left, right, m) of a one-lane road, a street driven in its middle, or a two-lane road."""
    kind = rng.choice(3, p=(0.2, 0.4, 0.4))
    if kind == 0:
        half = rng.uniform(1.9, 2.6)
        return float(half), float(-half)
    if kind == 1:
        half = rng.uniform(3.0, 4.2)
        return float(half), float(-half)
    lane, shoulder = rng.uniform(2.9, 3.6), rng.uniform(0.1, 1.2)
    near, far = lane / 2 + shoulder, min(lane * 1.5 + shoulder, 6.5)
    return (float(far), float(-near)) if rng.random() < 0.75 else (float(near), float(-far))
