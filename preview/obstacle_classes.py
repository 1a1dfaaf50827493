"""Estimator's priors of the obstacle classes: templates with their sizes, edge bias and look-alikes.

Families of shapes with free length and height; their priors span what design rules allow and surveys find,
length along the road by height:

* bump: Indonesia, Permenhub PM 14/2021 art. 3: 0.35-0.39 m by 5-9 cm; Brazil, CONTRAN resolution 600/2016,
  type B: 1.50 m by 6-8 cm. block: bolt-on bumps of rubber, trapezoidal; no rule, 5-7 cm are sold.
* hump (round top): the UK's 3.7 m by 75 or 100 mm (TRL 186); the Highways (Road Humps) Regulations 1999, S.I.
  1999/1025, ask for at least 0.9 m and 25-100 mm; Brazil type A 3.70 m by 8-10 cm; USA 12 ft by 3-4 in
  (Redmond WA; Montgomery County MD 3 in).
* sinusoidal: hump tangent to the road, of the same size; Netherlands, Denmark, UK (TRL 377).
* table, long_table: flat tops 75-100 mm high with ramps of 1:10 to 1:15 (TRL 186); USA 12 or 22 ft by 3 in
  (Montgomery County MD; Valencia County NM, § 70.02); Indonesia 6.6 m on top by 8-9 cm; Leicestershire at
  least 7 m on top by 75 mm.
* cushion: 1.7-3.7 m by 60-80 mm with ramps of 1:8 (UK Department for Transport, Local Transport Note 1/07).
* pothole: the classes of ASTM D6433, read second-hand, end at a diameter of 0.75 m and begin their deepest at
  50 mm, whatever the diameter; shallower ones matter little to ride comfort. Boxes do not show a depth.

For an object outside its prior the boxes dominate.
"""

from dataclasses import dataclass
from typing import Literal

from foreride.road.obstacle_classes import CLASS_NAMES, OBSTACLE_CLASSES


@dataclass(frozen=True)
class ObstacleTemplate:
    """Obstacle template: priors of an obstacle kind, mean and standard deviation of length and height.

    cls: obstacle class; share: prior probability within its class; profile: shape of the section along the
    road (see `preview.tracking.obstacle_templates`); feature: kind of the road feature that it models;
    ramp_m: usual length of a ramp.
    """

    name: str
    cls: int
    share: float
    length_m: float
    length_sigma_m: float
    height_m: float
    height_sigma_m: float
    profile: Literal["half_sine", "parabola", "cosine", "ramps", "walls"]
    feature: str
    ramp_m: float = 0.0

    @property
    def sign(self) -> float:
        """+1 for raised, -1 for a hole."""
        return OBSTACLE_CLASSES[self.cls].sign


@dataclass(frozen=True)
class ClassPrior:
    """Priors of a class that its templates share.

    edge_sigma_px: standard deviation of the bottom-edge bias, beyond errors that shift the boxes of all
    classes alike. real_probability: that a repeatedly detected object is real. confirm_existence,
    near_confirm_existence: existence above which a track is confirmed, far away and near. A far object will
    be seen better, so more is asked of it; on the last metres many look-alikes lose their existence, and
    small potholes gain theirs.
    """

    edge_sigma_px: float
    real_probability: float
    confirm_existence: float
    near_confirm_existence: float


_PRIORS = {
    "speed_bump": ClassPrior(0.3, 0.99, 0.96, 0.88),
    "pothole": ClassPrior(0.5, 0.97, 0.94, 0.8),  # stains and patches look like holes
}
EDGE_SIGMA_PX = tuple(_PRIORS[name].edge_sigma_px for name in CLASS_NAMES)
REAL_PROBABILITY = tuple(_PRIORS[name].real_probability for name in CLASS_NAMES)
CONFIRM_EXISTENCE = tuple(_PRIORS[name].confirm_existence for name in CLASS_NAMES)
NEAR_CONFIRM_EXISTENCE = tuple(_PRIORS[name].near_confirm_existence for name in CLASS_NAMES)

_BUMP, _HOLE = CLASS_NAMES.index("speed_bump"), CLASS_NAMES.index("pothole")
BUMP = ObstacleTemplate("bump", _BUMP, 0.3, 0.45, 0.20, 0.070, 0.020, "half_sine", "half_sine_bump")
BLOCK = ObstacleTemplate("block", _BUMP, 0.1, 0.60, 0.25, 0.055, 0.015, "ramps", "trapezoidal_bump", 0.2)
HUMP = ObstacleTemplate("hump", _BUMP, 0.2, 3.7, 0.70, 0.080, 0.020, "parabola", "watts_hump")
SINUSOIDAL = ObstacleTemplate("sinusoidal", _BUMP, 0.1, 3.7, 0.70, 0.080, 0.020, "cosine", "sinusoidal_hump")
TABLE = ObstacleTemplate("table", _BUMP, 0.15, 3.9, 0.90, 0.080, 0.018, "ramps", "flat_top_hump", 0.9)
LONG_TABLE = ObstacleTemplate(
    "long_table", _BUMP, 0.05, 7.0, 0.90, 0.080, 0.015, "ramps", "flat_top_hump", 0.9
)
CUSHION = ObstacleTemplate("cushion", _BUMP, 0.1, 2.7, 0.60, 0.068, 0.010, "ramps", "speed_cushion", 0.55)
POTHOLE = ObstacleTemplate("pothole", _HOLE, 1.0, 0.60, 0.30, 0.070, 0.025, "walls", "pothole")
KINDS = (BUMP, BLOCK, HUMP, SINUSOIDAL, LONG_TABLE, TABLE, CUSHION, POTHOLE)
TEMPLATE_OF_FEATURE = {template.feature: template for template in KINDS}


def templates_of(cls: int) -> tuple[ObstacleTemplate, ...]:
    """Obstacle templates of an obstacle class."""
    return tuple(kind for kind in KINDS if kind.cls == cls)
