"""Random half cars from small to large, soft to stiff: the parameters that a scenario replaces.

Ranges cover the measured cars of R. W. Allen et al., Vehicle Dynamic Stability and Rollover, DOT HS 807 956,
1992, and textbook ranges (J. Y. Wong, Theory of Ground Vehicles, chapter 7; T. D. Gillespie, Fundamentals of
Vehicle Dynamics, chapter 5), widened downwards to the 0.85 Hz of comfortable limousines.
"""

from typing import Any, NamedTuple

import numpy as np

BODY_HZ = (0.85, 1.9)
"""Natural frequency of the body on its front springs."""
WHEEL_HZ = (10.0, 12.5)
DAMPING_RATIO = (0.2, 0.35)


class _Axle(NamedTuple):
    spring_n_m: float
    tyre_n_m: float
    unsprung_mass_kg: float
    damping_min_ns_m: float
    damping_max_ns_m: float
    damping_passive_ns_m: float
    stop_gap_m: float


def random_car(rng: np.random.Generator) -> dict[str, Any]:
    """Parameters of one side of a random car, rounded to three digits."""
    mass, wheelbase, to_rear = rng.uniform(550.0, 1100.0), rng.uniform(2.4, 3.0), rng.uniform(0.42, 0.56)
    front, rear = to_rear * wheelbase, (1.0 - to_rear) * wheelbase
    body_hz, damping_ratio = rng.uniform(*BODY_HZ), rng.uniform(*DAMPING_RATIO)
    low, high = rng.uniform(0.15, 0.3), rng.uniform(2.2, 3.5)
    axles = [
        _axle(rng, share * mass, hertz, damping_ratio, (low, high))
        for share, hertz in ((1.0 - to_rear, body_hz), (to_rear, body_hz * rng.uniform(1.0, 1.15)))
    ]
    pairs = {name: list(values) for name, values in zip(_Axle._fields, zip(*axles, strict=True), strict=True)}
    car = pairs | {
        "body_mass_kg": mass,
        "pitch_inertia_kg_m2": rng.uniform(0.7, 0.95) * mass * front * rear,
        "front_axle_m": front,
        "rear_axle_m": rear,
        "damper_lag_s": rng.uniform(0.006, 0.012),
        "wheel_radius_m": rng.uniform(0.29, 0.36),
        "track_m": rng.uniform(1.42, 1.62),
        "cg_height_m": rng.uniform(0.5, 0.7),
        "seat_x_m": [-0.05 * wheelbase, -0.36 * wheelbase],
    }
    return {name: rounded(value) for name, value in car.items()}


def _axle(
    rng: np.random.Generator, carried_kg: float, hertz: float, ratio: float, reach: tuple[float, float]
) -> _Axle:
    """Axle that carries this mass; `reach`: range of the damper relative to the passive setting."""
    spring = carried_kg * (2 * np.pi * hertz) ** 2
    wheel = rng.uniform(0.09, 0.13) * carried_kg
    tyre = wheel * (2 * np.pi * rng.uniform(*WHEEL_HZ)) ** 2 - spring
    passive = 2 * ratio * np.sqrt(spring * carried_kg)
    return _Axle(
        spring, tyre, wheel, reach[0] * passive, reach[1] * passive, passive, rng.uniform(0.06, 0.09)
    )


def rounded(value: Any, digits: int = 3) -> Any:
    """The value, or each of a list, with so many significant digits."""
    return (
        [rounded(one, digits) for one in value] if isinstance(value, list) else float(f"{value:.{digits}g}")
    )
