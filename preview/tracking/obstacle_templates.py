"""Obstacle templates: kinds of obstacle with size priors, unit profiles, and effective tyre profiles.

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
from functools import lru_cache

import numpy as np

from foreride.road.tyre.wheel_profile import envelope

Array = np.ndarray
TEMPLATE_STEP_M = 0.01
TEMPLATE_MARGIN_M = 0.5  # more than a wheel radius, so that the envelope is back to zero at both ends
RAMP = 1.0 / 6.0  # ramp length of a table, as a share of its length
_WALL_M = 0.06  # wall length of potholes, from rim to floor


@dataclass(frozen=True)
class ObstacleTemplate:
    """Obstacle template: priors of an obstacle kind, mean and standard deviation of length and height.

    cls: detector class; sign: +1 for raised, -1 for a hole; share: prior probability within its class.
    """

    name: str
    cls: int
    sign: float
    share: float
    length_m: float
    length_sigma_m: float
    height_m: float
    height_sigma_m: float


BUMP = ObstacleTemplate("bump", 0, 1.0, 0.5, 0.45, 0.10, 0.075, 0.015)
HUMP = ObstacleTemplate("hump", 0, 1.0, 0.25, 3.3, 0.50, 0.090, 0.015)
TABLE = ObstacleTemplate("table", 0, 1.0, 0.25, 3.6, 0.60, 0.090, 0.015)
POTHOLE = ObstacleTemplate("pothole", 1, -1.0, 1.0, 0.60, 0.30, 0.070, 0.025)
KINDS = (BUMP, HUMP, TABLE, POTHOLE)


def templates_of(cls: int) -> tuple[ObstacleTemplate, ...]:
    """Obstacle templates of detector class `cls`."""
    return tuple(kind for kind in KINDS if kind.cls == cls)


def unit_profile(
    kind: ObstacleTemplate, share: Array, length_m: float | Array, ramp: float | Array = RAMP
) -> Array:
    """Unit profile at `share` (0..1) of the length, in units of the height, zero at both ends.

    A narrow bump is a half sine, a hump a parabola (a close approximation of Watts' circular arc), a table
    flat with ramps of `ramp`, a share of its length. A hole counts its depth as negative height.
    """
    if kind is BUMP:
        return np.sin(np.pi * share)
    edge = np.minimum(share, 1.0 - share)
    if kind is HUMP:
        return 4.0 * share * (1.0 - share)
    if kind is TABLE:
        return np.minimum(edge / ramp, 1.0)
    return -np.minimum(edge * length_m / _WALL_M, 1.0)


def chord(length_m: float, width_m: float, offset_m: float) -> float:
    """Length (m) along the road of an elliptic outline, `offset_m` beside its centre; 0 outside."""
    ratio = 2.0 * offset_m / max(width_m, 1e-6)
    return length_m * float(np.sqrt(max(0.0, 1.0 - ratio**2)))


def tyre_profile(kind: ObstacleTemplate, length_m: float, height_m: float) -> tuple[Array, Array]:
    """(x, height): the effective profile under a tyre, x in m from the near edge.

    Zero at both ends, so it may be continued flat. Lengths are rounded to 1 cm and heights to 2 mm.
    """
    return _tyre_profile(kind, round(length_m, 2), round(height_m / 0.002) * 0.002)


@lru_cache(maxsize=512)
def _tyre_profile(kind: ObstacleTemplate, length_m: float, height_m: float) -> tuple[Array, Array]:
    steps = round((length_m + 2 * TEMPLATE_MARGIN_M) / TEMPLATE_STEP_M)
    x = np.arange(steps + 1) * TEMPLATE_STEP_M - TEMPLATE_MARGIN_M
    share = np.clip(x / max(length_m, 1e-6), 0.0, 1.0)
    height = envelope(height_m * unit_profile(kind, share, length_m), TEMPLATE_STEP_M)
    x.setflags(write=False)
    height.setflags(write=False)
    return x, height
