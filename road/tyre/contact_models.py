"""Tyre enveloping models: from road height to the effective height under short obstacles."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import ArrayLike, NDArray

from foreride.files.reading.ranges import Checked

PART = 1 << 17  # stations whose means are formed at once


@dataclass(frozen=True)
class RigidWheel(Checked):
    """Rigid-wheel enveloping: a rigid circle rolling over the road, then the mean over the contact patch.

    z_env(x) = max over |u| < R of z(x + u) + sqrt(R^2 - u^2) - R. The circle cannot enter gaps shorter than
    itself; it lifts ahead of a rising edge and rolls off a falling edge along an arc. `patch_m` is the length
    of the mean, 0 for none.
    """

    kind: ClassVar[str] = "rigid_wheel"
    patch_m: Annotated[float, Interval(ge=0.0, le=1.0), "m"] = 0.1

    def effective_height(self, heights: ArrayLike, step_m: float, radius_m: float) -> NDArray[np.float64]:
        """Effective heights (..., n) of `heights` (m) every `step_m` along x, constant beyond both ends."""
        z = _cam_profile(np.asarray(heights, float), step_m, radius_m, radius_m, 2.0)
        return patch_mean(z, step_m, self.patch_m)


@dataclass(frozen=True)
class TandemCam(Checked):
    """Tandem-cam enveloping (Schmeitz): two elliptical cams in line; the effective height is their mean.

    A. J. C. Schmeitz, A Semi-Empirical Three-Dimensional Model of the Pneumatic Tyre Rolling over Arbitrarily
    Uneven Road Surfaces, thesis, TU Delft 2004; Pacejka, Tyre and Vehicle Dynamics, 3rd ed., ch. 10. Each cam
    is the superellipse (|x| / a)^c + (|z| / b)^c = 1, which stands upright and follows the road. The defaults
    are those of the 205/60R15 tyre of MF-Tyre/MF-Swift (TNO_car205_60R15.tir: ELLIPS_SHIFT 0.8335,
    ELLIPS_LENGTH 1.471, ELLIPS_HEIGHT 0.9622, ELLIPS_ORDER 1.5174), whose contact patch is 0.132 m long at
    4 kN by its Q_RA1 and Q_RA2.

    Args:
        length, height: semi-axes a and b over the tyre's radius.
        order: exponent c of the superellipse.
        contact_m: length of the contact patch.
        shift: distance between the cams over `contact_m`.
    """

    kind: ClassVar[str] = "tandem_cam"
    length: Annotated[float, Interval(ge=0.1, le=3.0), "1"] = 1.471
    height: Annotated[float, Interval(ge=0.1, le=3.0), "1"] = 0.9622
    order: Annotated[float, Interval(ge=1.0, le=4.0), "1"] = 1.5174
    contact_m: Annotated[float, Interval(ge=0.0, le=1.0), "m"] = 0.132
    shift: Annotated[float, Interval(ge=0.0, le=2.0), "1"] = 0.8335

    def effective_height(self, heights: ArrayLike, step_m: float, radius_m: float) -> NDArray[np.float64]:
        """Effective heights (..., n) of `heights` (m) every `step_m` along x, constant beyond both ends."""
        z = np.asarray(heights, float)
        cam = _cam_profile(z, step_m, self.length * radius_m, self.height * radius_m, self.order)
        half = self.shift * self.contact_m / 2 / step_m
        reach = int(np.ceil(half)) + 1
        padded = np.pad(cam, [(0, 0)] * (z.ndim - 1) + [(reach, reach)], mode="edge")
        centre = np.arange(z.shape[-1], dtype=np.float64) + reach
        return (_interpolate(padded, centre + half) + _interpolate(padded, centre - half)) / 2


@dataclass(frozen=True)
class PointContact(Checked):
    """Point contact: the road's own height, as in linear quarter-car studies, or its mean over `patch_m`.

    The mean over 0.25 m without a wheel is the tyre of the International Roughness Index.
    """

    kind: ClassVar[str] = "point"
    patch_m: Annotated[float, Interval(ge=0.0, le=1.0), "m"] = 0.0

    def effective_height(self, heights: ArrayLike, step_m: float, radius_m: float) -> NDArray[np.float64]:
        """Effective heights (..., n) of `heights` (m) every `step_m` along x, constant beyond both ends."""
        return patch_mean(np.asarray(heights, float), step_m, self.patch_m)


Enveloping = RigidWheel | TandemCam | PointContact


def patch_mean(z: NDArray[np.float64], step_m: float, patch_m: float) -> NDArray[np.float64]:
    """Exact integral mean of the linear interpolant of (..., n) heights over x +- patch / 2."""
    if patch_m == 0:
        return z
    half = patch_m / 2 / step_m
    reach = int(np.ceil(half))
    padded = np.pad(z, [(0, 0)] * (z.ndim - 1) + [(reach + 1, reach + 1)], mode="edge")
    area = np.zeros(padded.shape)
    np.cumsum((padded[..., 1:] + padded[..., :-1]) / 2, axis=-1, out=area[..., 1:])
    mean = np.empty(z.shape)
    for first in range(0, z.shape[-1], PART):
        centre = np.arange(first, min(first + PART, z.shape[-1]), dtype=np.float64) + (reach + 1)
        ahead, behind = (_integrate_to(padded, area, centre + step) for step in (half, -half))
        mean[..., first : first + PART] = (ahead - behind) / (2 * half)
    return mean


def _cam_profile(
    z: NDArray[np.float64], step_m: float, half_length_m: float, half_height_m: float, order: float
) -> NDArray[np.float64]:
    """Height of the lowest point of an upright superellipse resting on the road, at each station."""
    reach = int(half_length_m / step_m)
    padded = np.pad(z, [(0, 0)] * (z.ndim - 1) + [(reach, reach)], mode="edge")
    station_ratio = step_m * np.arange(reach + 1) / max(half_length_m, step_m)
    drop = half_height_m * (1.0 - np.maximum(1.0 - station_ratio**order, 0.0) ** (1 / order))
    result, height_range = z.copy(), np.ptp(z)
    for shift in range(-reach, reach + 1):
        if drop[abs(shift)] <= height_range:  # otherwise this part of the cam cannot touch the road
            window = padded[..., reach + shift : reach + shift + z.shape[-1]]
            np.maximum(result, window - drop[abs(shift)], out=result)
    return result


def _interpolate(z: NDArray[np.float64], position: NDArray[np.float64]) -> NDArray[np.float64]:
    """Linear interpolant of z at fractional grid positions."""
    cell = np.floor(position).astype(np.int64)
    return z[..., cell] + (position - cell) * (z[..., cell + 1] - z[..., cell])


def _integrate_to(
    z: NDArray[np.float64], area: NDArray[np.float64], position: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Integral of the linear interpolant of z from 0 to fractional grid positions."""
    cell = np.floor(position).astype(np.int64)
    fraction = position - cell
    return area[..., cell] + fraction * z[..., cell] + fraction**2 / 2 * (z[..., cell + 1] - z[..., cell])
