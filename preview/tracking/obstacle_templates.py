"""Unit profiles of the obstacle templates, and their effective profiles under a tyre."""

from functools import lru_cache

import numpy as np

from foreride.preview.obstacle_classes import ObstacleTemplate
from foreride.road.tyre.tyre import Tyre

Array = np.ndarray
TEMPLATE_STEP_M = 0.01
TEMPLATE_MARGIN_M = 0.5  # at least; more than a wheel radius, so that both ends are flat under the tyre
_WALL_M = 0.06  # wall length of potholes, from rim to floor


def ramp_share(kind: ObstacleTemplate, length_m: float | Array) -> Array:
    """Usual length of a ramp, as a share of the length."""
    return np.clip(kind.ramp_m / np.maximum(length_m, 1e-6), 1e-3, 0.5)


def unit_profile(
    kind: ObstacleTemplate, share: Array, length_m: float | Array, ramp: float | Array | None = None
) -> Array:
    """Unit profile at `share` (0..1) of the length, in units of the height, zero at both ends.

    A narrow bump is a half sine, a round hump a parabola (a close approximation of Watts' circular arc), a
    sinusoidal hump a raised cosine; a table is flat with ramps of `ramp`, a share of its length. A hole
    counts its depth as negative height.
    """
    if kind.profile == "half_sine":
        return np.sin(np.pi * share)
    if kind.profile == "cosine":
        return np.sin(np.pi * share) ** 2
    edge = np.minimum(share, 1.0 - share)
    if kind.profile == "parabola":
        return 4.0 * share * (1.0 - share)
    if kind.profile == "ramps":
        return np.minimum(edge / (ramp_share(kind, length_m) if ramp is None else ramp), 1.0)
    return -np.minimum(edge * length_m / _WALL_M, 1.0)


def chord(length_m: float, width_m: float, offset_m: float) -> float:
    """Length (m) along the road of an elliptic outline, `offset_m` beside its centre; 0 outside."""
    ratio = 2.0 * offset_m / max(width_m, 1e-6)
    return length_m * float(np.sqrt(max(0.0, 1.0 - ratio**2)))


def tyre_profile(
    kind: ObstacleTemplate, length_m: float, height_m: float, tyre: Tyre | None = None
) -> tuple[Array, Array]:
    """(x, height): the effective profile under a tyre, x in m from the near edge.

    Zero at both ends, so it may be continued flat. Lengths are rounded to 1 cm and heights to 2 mm.
    """
    return _tyre_profile(kind, round(length_m, 2), round(height_m / 0.002) * 0.002, tyre or Tyre())


@lru_cache(maxsize=512)
def _tyre_profile(
    kind: ObstacleTemplate, length_m: float, height_m: float, tyre: Tyre
) -> tuple[Array, Array]:
    margin_m = max(TEMPLATE_MARGIN_M, 1.6 * tyre.radius_m)
    steps = round((length_m + 2 * margin_m) / TEMPLATE_STEP_M)
    x = np.arange(steps + 1) * TEMPLATE_STEP_M - margin_m
    share = np.clip(x / max(length_m, 1e-6), 0.0, 1.0)
    height = tyre.effective_height(height_m * unit_profile(kind, share, length_m), TEMPLATE_STEP_M)
    x.setflags(write=False)
    height.setflags(write=False)
    return x, height
