"""Estimator's priors of the obstacle classes: templates with their sizes, edge bias and look-alikes.

Size priors cover what road-design rules allow, length along the road by height:

* bump: Indonesia, Permenhub PM 14/2021 art. 3: 0.35-0.39 m by 5-9 cm.
* hump: the UK's round-top hump, 3.7 m, built 75 or 100 mm high (TRL 186; the Highways (Road Humps)
  Regulations 1999, S.I. 1999/1025, ask for at least 0.9 m and 25-100 mm); Brazil, CONTRAN resolution 600/2016
  as the road-safety manual of DER/SP gives it (p. 339): type A 3.70 m by 8-10 cm; USA: 12 ft by 3-4 in
  (Redmond WA; Montgomery County MD 3 in). Brazil's type B, 1.50 m by 6-8 cm, lies below the prior.
* table: the UK's flat-top humps are as high, with ramps of 1:10 to 1:15 (TRL 186). Those of the USA, up to
  22 ft by 3 in (Valencia County NM, § 70.02), and of Indonesia, 6.6 m on top by 8-9 cm, lie above the prior.
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
    road (see `preview.tracking.obstacle_templates`); feature: kind of the road feature that it models.
    """

    name: str
    cls: int
    share: float
    length_m: float
    length_sigma_m: float
    height_m: float
    height_sigma_m: float
    profile: Literal["half_sine", "parabola", "ramps", "walls"]
    feature: str

    @property
    def sign(self) -> float:
        """+1 for raised, -1 for a hole."""
        return OBSTACLE_CLASSES[self.cls].sign


@dataclass(frozen=True)
class ClassPrior:
    """Priors of a class that its templates share.

    edge_sigma_px: standard deviation of the bottom-edge bias, beyond errors that shift the boxes of all
    classes alike. real_probability: that a repeatedly detected object is real.
    """

    edge_sigma_px: float
    real_probability: float


_PRIORS = {
    "speed_bump": ClassPrior(0.3, 0.99),
    "pothole": ClassPrior(0.5, 0.97),  # stains and patches look like holes
}
EDGE_SIGMA_PX = tuple(_PRIORS[name].edge_sigma_px for name in CLASS_NAMES)
REAL_PROBABILITY = tuple(_PRIORS[name].real_probability for name in CLASS_NAMES)

_BUMP, _HOLE = CLASS_NAMES.index("speed_bump"), CLASS_NAMES.index("pothole")
BUMP = ObstacleTemplate("bump", _BUMP, 0.5, 0.45, 0.10, 0.075, 0.015, "half_sine", "half_sine_bump")
HUMP = ObstacleTemplate("hump", _BUMP, 0.25, 3.3, 0.50, 0.090, 0.015, "parabola", "watts_hump")
TABLE = ObstacleTemplate("table", _BUMP, 0.25, 3.6, 0.60, 0.090, 0.015, "ramps", "flat_top_hump")
POTHOLE = ObstacleTemplate("pothole", _HOLE, 1.0, 0.60, 0.30, 0.070, 0.025, "walls", "pothole")
KINDS = (BUMP, HUMP, TABLE, POTHOLE)
TEMPLATE_OF_FEATURE = {template.feature: template for template in KINDS}


def templates_of(cls: int) -> tuple[ObstacleTemplate, ...]:
    """Obstacle templates of an obstacle class."""
    return tuple(kind for kind in KINDS if kind.cls == cls)
