"""Side view of the car on the road, to scale except for enlarged vertical motion."""

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np

from foreride.scenarios.simulation.simulate import Run

Colour = tuple[int, int, int]
SKY: Colour = (244, 246, 248)
GROUND: Colour = (96, 98, 102)
DARK: Colour = (34, 36, 40)
HEIGHT_SCALE = 4.0
"""Magnification of vertical motion; the car's own shape is to scale."""


@dataclass(frozen=True)
class View:
    """Window of `width_px` x `height_px` that shows `span_m` of road around the car."""

    width_px: int
    height_px: int
    span_m: float = 11.0

    @property
    def scale(self) -> float:
        """Pixels per metre."""
        return self.width_px / self.span_m

    def column(self, forward_m: float | np.ndarray) -> np.ndarray:
        """Image column of a point `forward_m` ahead of the car's centre."""
        return np.asarray(forward_m) * self.scale + 0.40 * self.width_px

    def row(self, up_m: float | np.ndarray) -> np.ndarray:
        """Image row of a height above the road."""
        return 0.78 * self.height_px - np.asarray(up_m) * self.scale


def _fill(image: np.ndarray, columns: np.ndarray, rows: np.ndarray, colour: Colour) -> None:
    points = np.stack([columns, rows], axis=-1) * 16
    cv2.fillPoly(image, [np.round(points).astype(np.int32)], colour, cv2.LINE_AA, shift=4)


def _disc(image: np.ndarray, column: float, row: float, radius: float, colour: Colour) -> None:
    centre = (round(float(column) * 16), round(float(row) * 16))
    cv2.circle(image, centre, round(radius * 16), colour, -1, cv2.LINE_AA, shift=4)


_BODY_X = np.array([2.05, 2.0, 1.0, 0.45, -0.95, -1.75, -2.1, -2.1, 2.05])
_BODY_Z = np.array([0.32, 0.72, 0.86, 1.38, 1.42, 1.0, 0.9, 0.34, 0.30])
_GLASS_X = np.array([0.85, 0.42, -0.9, -1.45])
_GLASS_Z = np.array([0.88, 1.30, 1.34, 0.97])


def _body(
    view: View, heave: float, pitch: float, xs: np.ndarray, zs: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    angle = pitch * HEIGHT_SCALE
    x = xs * np.cos(angle) + (zs - 0.5) * np.sin(angle)
    z = 0.5 + (zs - 0.5) * np.cos(angle) - xs * np.sin(angle) + heave * HEIGHT_SCALE
    return view.column(x), view.row(z)


@cache
def _sky(view: View) -> np.ndarray:
    return np.full((view.height_px, view.width_px, 3), SKY, np.uint8)


def draw(run: Run, tick: int, view: View, colour: Colour) -> np.ndarray:
    """Draw the car of `run` at `tick` as an RGB image (height_px, width_px, 3)."""
    image = _sky(view).copy()
    signals, vehicle = run.signals, run.case.scenario.vehicle.parameters
    x = float(signals["x_m"][tick])
    forward = np.linspace(-0.42, 0.62, 400) * view.span_m
    surface = run.case.scenario.road.height(x + forward, np.full_like(forward, run.track_y_m)) * HEIGHT_SCALE
    columns, rows = view.column(forward), view.row(surface)
    _fill(image, np.r_[columns, columns[-1], columns[0]], np.r_[rows, view.height_px, view.height_px], GROUND)
    heave = float(signals["heave_m"][tick])
    pitch = float(signals["pitch_rad"][tick]) if "pitch_rad" in signals else 0.0
    axles = vehicle.axle_x_m if vehicle.wheels > 1 else (1.25, -1.45)
    _fill(image, *_body(view, heave, pitch, _BODY_X, _BODY_Z), colour)
    _fill(image, *_body(view, heave, pitch, _GLASS_X, _GLASS_Z), SKY)
    for index, axle in enumerate(axles):
        wheel = min(index, vehicle.wheels - 1)
        lift = float(signals[f"wheel_z_{wheel}"][tick]) * HEIGHT_SCALE
        centre = float(view.column(axle)), float(view.row(vehicle.wheel_radius_m + lift))
        _disc(image, *centre, vehicle.wheel_radius_m * view.scale, DARK)
        _disc(image, *centre, 0.55 * vehicle.wheel_radius_m * view.scale, (205, 208, 212))
    return image
