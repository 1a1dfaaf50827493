"""International Roughness Index (IRI): mean suspension stroke of the golden car at 80 km/h per distance.

Sayers, On the Calculation of International Roughness Index from Longitudinal Road Profile, Transportation
Research Record 1501, 1995; World Bank Technical Paper 46, 1986; ASTM E1926.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import expm

from foreride.files.errors import InputError
from foreride.files.reading.checks import check_number

SPEED_M_S = 80 / 3.6
# Golden car, all per sprung mass: tyre and suspension stiffness (1/s²), damping (1/s), wheel mass.
TYRE_STIFFNESS_S2, SPRING_STIFFNESS_S2, DAMPING_S, UNSPRUNG_MASS_RATIO = 653.0, 63.3, 6.0, 0.15
ENVELOPE_BASE_M = 0.25  # length of the moving average that models tyre enveloping
INITIAL_SLOPE_BASE_M = 11.0  # length whose mean slope initialises the states
MAX_STEP_M = 0.3  # ASTM E1926


def iri(heights: ArrayLike, step_m: float) -> float:
    """IRI (m/km) of a profile of (n,) heights (m) every `step_m` along x.

    Raises InputError for a step over MAX_STEP_M, a road shorter than INITIAL_SLOPE_BASE_M, or heights
    that are not finite.
    """
    return float(np.mean(rectified_slope(heights, step_m)) * 1000)


def rectified_slope(heights: ArrayLike, step_m: float) -> NDArray[np.float64]:
    """Rectified slope |stroke rate / speed| of the golden car in each interval; its mean is the IRI (m/m)."""
    z = np.asarray(heights, float)
    check_number("step_m", step_m, 0.0, MAX_STEP_M, open_low=True)
    if z.ndim != 1 or not np.all(np.isfinite(z)):
        raise InputError(f"heights must be (n,) finite values, got shape {z.shape}")
    if (len(z) - 1) * step_m < INITIAL_SLOPE_BASE_M:
        raise InputError(
            f"IRI: road must be >= {INITIAL_SLOPE_BASE_M:g} m long, got {(len(z) - 1) * step_m:g} m"
        )
    start = min(_nearest_count(INITIAL_SLOPE_BASE_M, step_m), len(z) - 1)
    initial = (z[start] - z[0]) / (start * step_m)
    samples = max(1, _nearest_count(ENVELOPE_BASE_M, step_m))
    smooth = np.convolve(z, np.full(samples, 1 / samples), mode="valid")
    return np.abs(_stroke_slope(np.diff(smooth) / step_m, initial, step_m))


def _nearest_count(length_m: float, step_m: float) -> int:
    """Steps nearest to a length, halves upwards as Sayers' INT(L / DX + 0.5), despite rounding of L / DX."""
    return int(length_m / step_m + 0.5 + 1e-9)


def transition(step_m: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """State transition (4, 4) and input (4,) matrices of the golden car over `step_m` of constant slope.

    States: slope of the body's trajectory, its rate of change (1/s), then the same of the wheel.
    """
    return _discretise(_golden_car(), step_m / SPEED_M_S)


def response(wavenumber: ArrayLike) -> NDArray[np.complex128]:
    """Frequency response, stroke slope over profile slope, in closed form; wavenumber in cycles/m."""
    s = 2j * np.pi * np.asarray(wavenumber, float) * SPEED_M_S
    body = s**2 + DAMPING_S * s + SPRING_STIFFNESS_S2
    wheel = UNSPRUNG_MASS_RATIO * s**2 + DAMPING_S * s + SPRING_STIFFNESS_S2 + TYRE_STIFFNESS_S2
    coupling = DAMPING_S * s + SPRING_STIFFNESS_S2
    # Body and wheel over road are coupling · k / d and body · k / d; their difference is -s² k / d.
    return -TYRE_STIFFNESS_S2 * s**2 / (body * wheel - coupling**2)


def _golden_car() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    k, c = SPRING_STIFFNESS_S2, DAMPING_S
    a = np.array(
        [
            [0, 1, 0, 0],
            [-k, -c, k, c],
            [0, 0, 0, 1],
            [
                k / UNSPRUNG_MASS_RATIO,
                c / UNSPRUNG_MASS_RATIO,
                -(TYRE_STIFFNESS_S2 + k) / UNSPRUNG_MASS_RATIO,
                -c / UNSPRUNG_MASS_RATIO,
            ],
        ],
        float,
    )
    return a, np.array([0.0, 0.0, 0.0, TYRE_STIFFNESS_S2 / UNSPRUNG_MASS_RATIO])


def _discretise(
    model: tuple[NDArray[np.float64], NDArray[np.float64]], dt: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    a, b = model
    exponent = np.zeros((5, 5))
    exponent[:4, :4], exponent[:4, 4] = a * dt, b * dt
    transition_block = expm(exponent)
    return transition_block[:4, :4], transition_block[:4, 4]


def _stroke_slope(slope: NDArray[np.float64], initial: float, step_m: float) -> NDArray[np.float64]:
    """Body slope minus wheel slope after each interval, in modal form to avoid a loop over stations."""
    from scipy.signal import lfilter  # slow to import

    phi, gamma = transition(step_m)
    eigenvalues, vectors = np.linalg.eig(phi)
    inputs = np.linalg.solve(vectors, gamma.astype(complex))
    start = np.linalg.solve(vectors, np.array([initial, 0, initial, 0], complex))
    output = (vectors[0] - vectors[2])[:, None]
    modes = [
        lfilter([gain], [1.0, -pole], slope.astype(complex), zi=np.array([pole * initial_mode]))[0]
        for pole, gain, initial_mode in zip(eigenvalues, inputs, start, strict=True)
    ]
    return (output * np.array(modes)).sum(axis=0).real
