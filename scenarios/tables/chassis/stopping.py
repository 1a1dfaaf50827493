"""Stopping distance on a rough road, from the tyre loads of a braked car.

Each tyre brakes with its greatest force, as an ideal anti-lock control would have it. That force is
degressive in the load, mu = mu0 · (1 - s · (F/F0 - 1)), and follows it over the tyre's relaxation length:
sigma · dFx/dx + Fx = mu F (H. B. Pacejka, Tyre and Vehicle Dynamics, 3rd ed. 2012, chapters 4 and 7). So tyre
load that varies costs distance, and a wheel in the air brakes nothing. A brake pressure follows the available
force with a lag only, and the force is then the smaller one of both: the loss that dampers were found to
change by 1 to 2 % of the distance (T. Niemz and H. Winner, Reducing Braking Distance by Control of
Semi-Active Suspension, FISITA World Automotive Congress, 2006).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]
GRID_M = 0.02
"""Distance between the places at which loads are taken."""


class TyreGrip(NamedTuple):
    """Longitudinal grip of a tyre and its brake: peak friction, load sensitivity, relaxation length, lag.

    Defaults: a passenger-car tyre on dry asphalt; a hydraulic unit that changes the pressure in 0.1 s.
    """

    friction: float = 1.0
    load_sensitivity: float = 0.15
    relaxation_m: float = 0.3
    pressure_lag_s: float = 0.1


def brake_force(load: Array, static: Array, speed: Array, grip: TyreGrip, ideal: bool) -> Array:
    """Braking force (wheels, n) at places `GRID_M` apart, N, from loads (wheels, n) and speeds (n,).

    ideal: the slip is always the best one; otherwise the brake pressure lags.
    """
    relative = load / static[:, None]
    available = grip.friction * load * np.clip(1.0 - grip.load_sensitivity * (relative - 1.0), 0.0, None)
    available = _lagged(available, np.exp(-GRID_M / grip.relaxation_m))
    if ideal:
        return available
    pressure, follow = available.copy(), -np.expm1(-GRID_M / (np.maximum(speed, 0.5) * grip.pressure_lag_s))
    for place in range(1, load.shape[1]):
        before = pressure[:, place - 1]
        pressure[:, place] = before + follow[place] * (available[:, place] - before)
    return np.minimum(available, pressure)


def _lagged(values: Array, keep: float) -> Array:
    """First-order lag over the places (wheels, n), from the first value on."""
    lagged = lfilter([1.0 - keep], [1.0, -keep], values - values[:, :1], axis=1)
    return np.asarray(lagged) + values[:, :1]


def stopping_distance(
    place_m: Array, speed_m_s: Array, load: Array, static: Array, grip: TyreGrip, ideal: bool = True
) -> float:
    """Distance in which a car of these wheels' static loads stops from its first speed, m.

    place_m, speed_m_s (n,) and load (wheels, n), N: recorded while braking along the road. Loads belong to
    the place where they were; after the last one the mean force is kept.
    """
    grid = np.arange(place_m[0], place_m[-1], GRID_M)
    speed = np.interp(grid, place_m, speed_m_s)
    loads = np.array([np.interp(grid, place_m, row) for row in load])
    mass = float(static.sum()) / 9.80665
    deceleration = brake_force(loads, static, speed, grip, ideal).sum(axis=0) / mass
    square = speed_m_s[0] ** 2 - 2.0 * GRID_M * np.cumsum(deceleration)
    stopped = np.flatnonzero(square <= 0.0)
    if len(stopped):
        last = int(stopped[0])
        return float(GRID_M * (last + 1) + square[last] / (2.0 * deceleration[last]))
    return float(GRID_M * len(grid) + square[-1] / (2.0 * deceleration.mean()))
