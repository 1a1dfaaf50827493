"""Elementary functions without branches or calls, which compile to vector instructions in loops."""

import numpy as np

from foreride.files.jit import njit

# Least-squares fit of odd powers to the arctangent in 0..1, to 5e-8 rad.
_ATAN = (
    0.999999249,
    -0.33329538,
    0.199430812,
    -0.138920412,
    0.096016564,
    -0.0553816979,
    0.0215092542,
    -0.00396025723,
)
_PER_LN2 = 2 / np.log(2)


@njit(nogil=True, error_model="numpy", inline="always")
def exp_minus(x):  # type: ignore[no-untyped-def]
    """exp(-x) of x >= 0, to 2e-6: (exp(-x / 64))^64."""
    s = min(x, 16.0) * (1 / 64)
    root = 1 - s * (1 - s * (1 / 2) * (1 - s * (1 / 3) * (1 - s * (1 / 4) * (1 - s * (1 / 5)))))
    root *= root
    root *= root
    root *= root
    root *= root
    root *= root
    return root * root


@njit(nogil=True, error_model="numpy", inline="always")
def log2_to_64(x):  # type: ignore[no-untyped-def]
    """Binary logarithm of x in 1..64, to 2e-5."""
    whole = 0.0
    eight = x >= 8
    x, whole = (x * 0.125 if eight else x), (3.0 if eight else 0.0)
    four = x >= 4
    x, whole = (x * 0.25 if four else x), (whole + 2.0 if four else whole)
    two = x >= 2
    x, whole = (x * 0.5 if two else x), (whole + 1.0 if two else whole)
    z = (x - 1) / (x + 1)
    square = z * z
    return whole + _PER_LN2 * z * (1 + square * (1 / 3 + square * (1 / 5 + square * (1 / 7))))


@njit(nogil=True, error_model="numpy", inline="always")
def arctan2(y, x):  # type: ignore[no-untyped-def]
    """Angle (rad) of a direction, to 5e-8."""
    rise, run = abs(y), abs(x)
    t = min(rise, run) / max(max(rise, run), 1e-30)
    s = t * t
    angle = t * (
        _ATAN[0]
        + s
        * (
            _ATAN[1]
            + s
            * (_ATAN[2] + s * (_ATAN[3] + s * (_ATAN[4] + s * (_ATAN[5] + s * (_ATAN[6] + s * _ATAN[7])))))
        )
    )
    angle = np.pi / 2 - angle if rise > run else angle
    angle = np.pi - angle if x < 0 else angle
    return -angle if y < 0 else angle
