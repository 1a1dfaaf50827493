"""Simulated drives toward features: kinematic car with known pitch and heave, imperfect sensors and boxes."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from foreride.detector.box_errors import BoxErrors, degrade
from foreride.detector.detections import Detections, exact
from foreride.preview.estimator import Estimator
from foreride.preview.prior_drives.memory_file import Memory
from foreride.preview.road_preview import RoadPreview
from foreride.preview.settings import Settings
from foreride.road.camera.pinhole import Camera, CameraMount, CameraPose, pose_of
from foreride.road.render.outline_boxes import outline_boxes
from foreride.road.road import Road
from foreride.road.tyre.wheel_profile import WheelProfile, wheel_profile

AXLES_M = (1.25, -1.45)
WHEEL_Y_M = (0.75, 0.75)


def true_boxes(road: Road, camera: Camera, pose: CameraPose, range_m: float = 30.0) -> Detections:
    """Exact detections of the features in sight."""
    return exact(*outline_boxes(road, camera, pose, range_m))


def box_errors(**more: float) -> BoxErrors:
    """Box errors without edge bias, as `unbiased` settings assume."""
    return BoxErrors(bottom_bias_px=(0.0, 0.0), top_bias_px=(0.0, 0.0), **more)


def unbiased(**more: float) -> Settings:
    """Settings for a detector without edge bias."""
    return Settings(bottom_bias_px=(0.0, 0.0), top_bias_px=(0.0, 0.0), **more)


class Reading(NamedTuple):
    """A `Measurement`."""

    body_acc: np.ndarray
    wheel_acc: np.ndarray
    rattle_m: np.ndarray
    pitch_rate: float
    speed_m_s: float
    roll_rate: float = 0.0


@dataclass(frozen=True)
class Drive:
    """Conditions: amplitudes of body motion, calibration errors, sensor noise, timing."""

    speed_kmh: float = 40.0
    seed: int = 0
    pitch_amplitude_deg: float = 0.4
    heave_amplitude_m: float = 0.012
    mount_pitch_error_deg: float = 0.2
    mount_height_error_m: float = 0.01
    gyro_sigma: float = 0.002
    gyro_bias: float = 0.002
    acc_sigma: float = 0.05
    acc_bias: float = 0.03
    rattle_sigma: float = 0.0005
    speed_sigma: float = 0.02
    speed_scale_sigma: float = 0.003
    latency_s: float = 0.05
    camera_hz: int = 20
    step_s: float = 0.005
    errors: BoxErrors = field(default_factory=lambda: box_errors())


class Snapshot(NamedTuple):
    """Track of a feature when the front wheel was `before_m` short of it."""

    error_m: float
    sigma_m: float
    kind: str
    length_m: float
    height_m: float
    existence: float
    preview: RoadPreview


def drive(
    road: Road,
    conditions: Drive,
    settings: Settings | None = None,
    before_m: float = 2.5,
    start_x_m: float = 5.0,
    memory: Memory | None = None,
) -> tuple[list[Snapshot | None], Estimator]:
    """Drive over the whole road; return one snapshot a feature (None: not tracked) and the estimator."""
    rng = np.random.default_rng(conditions.seed)
    camera, mount = Camera(), CameraMount()
    size_px = camera.width_px, camera.height_px
    true_mount = CameraMount(
        height_m=mount.height_m + conditions.mount_height_error_m * rng.standard_normal(),
        pitch_deg=mount.pitch_deg + conditions.mount_pitch_error_deg * rng.standard_normal(),
    )
    estimator = Estimator(
        camera, mount, AXLES_M, WHEEL_Y_M, settings or unbiased(), x_m=start_x_m, memory=memory
    )
    wheels = [wheel_profile(road, y) for y in WHEEL_Y_M]
    body = _Body(conditions, rng)
    speed = conditions.speed_kmh / 3.6
    scale = 1.0 + conditions.speed_scale_sigma * rng.standard_normal()
    biases = conditions.gyro_bias * rng.standard_normal(), conditions.acc_bias * rng.standard_normal()
    frame_every = round(1.0 / conditions.camera_hz / conditions.step_s)
    waiting: list[tuple[float, float, Detections]] = []
    shots: list[Snapshot | None] = [None] * len(road.features)
    taken = [False] * len(road.features)
    for tick in range(int((road.length_m - start_x_m) / speed / conditions.step_s)):
        t = tick * conditions.step_s
        x = start_x_m + speed * t
        estimator.update_motion(t, body.reading(t, x, speed * scale, wheels, biases, rng))
        if tick % frame_every == 0:
            pose = pose_of(true_mount, x, body.heave(t), body.pitch(t))
            boxes = true_boxes(road, camera, pose, conditions.errors.range_m)
            waiting.append((t + conditions.latency_s, t, degrade(boxes, size_px, conditions.errors, rng)))
        while waiting and waiting[0][0] <= t + 1e-9:
            _, exposure, detections = waiting.pop(0)
            estimator.update_boxes(exposure, detections)
        for number, feature in enumerate(road.features):
            if not taken[number] and feature.start_m - (x + AXLES_M[0]) <= before_m:
                taken[number] = True
                shots[number] = _snapshot(estimator, feature.start_m, t, x)
    return shots, estimator


def _snapshot(estimator: Estimator, start_m: float, t: float, x: float) -> Snapshot | None:
    rows = [row for row in estimator.stats() if row["confirmed"]]
    if not rows:
        return None
    drift = estimator.motion.at(t).x_m - x
    row = min(rows, key=lambda r: abs(r["x_m"] - drift - start_m))
    error = row["x_m"] - drift - start_m
    if abs(error) > 2.0:
        return None
    return Snapshot(
        error,
        row["sigma_m"],
        row["kind"],
        row["length_m"],
        row["height_m"],
        row["existence"],
        estimator.preview(t),
    )


class _Body:
    """Pitch and heave as sums of two sines near the body's resonances, on wheels that hop."""

    def __init__(self, conditions: Drive, rng: np.random.Generator) -> None:
        self.conditions = conditions
        self._frequency = np.array([1.1, 1.7]) * 2 * np.pi
        self._phase = rng.uniform(0, 2 * np.pi, (2, 2))
        self._pitch = np.deg2rad(conditions.pitch_amplitude_deg) * np.array([0.7, 0.3])
        self._heave = conditions.heave_amplitude_m * np.array([0.7, 0.3])
        self._wheel, self._wheel_velocity = np.zeros(2), np.zeros(2)

    def pitch(self, t: float, order: int = 0) -> float:
        turn = self._frequency * t + self._phase[0] + order * np.pi / 2
        return float((self._pitch * self._frequency**order * np.sin(turn)).sum())

    def heave(self, t: float, order: int = 0) -> float:
        turn = self._frequency * t + self._phase[1] + order * np.pi / 2
        return float((self._heave * self._frequency**order * np.sin(turn)).sum())

    def _roll(self, road: np.ndarray) -> np.ndarray:
        """Advance lightly damped wheels on their tyres; returns their acceleration."""
        step, hop = self.conditions.step_s, 2 * np.pi * 10.8
        acceleration = hop**2 * (road - self._wheel) - 0.3 * hop * self._wheel_velocity
        self._wheel_velocity = self._wheel_velocity + step * acceleration
        self._wheel = self._wheel + step * self._wheel_velocity
        return acceleration

    def reading(
        self,
        t: float,
        x: float,
        speed: float,
        wheels: list[WheelProfile],
        biases: tuple[float, float],
        rng: np.random.Generator,
    ) -> Reading:
        c = self.conditions
        axle = np.array(AXLES_M)
        road = np.array([p.height(x + a) for p, a in zip(wheels, AXLES_M, strict=True)])
        wheel_acc = self._roll(road)
        corner = self.heave(t) - axle * self.pitch(t)
        corner_acc = self.heave(t, 2) - axle * self.pitch(t, 2)
        return Reading(
            corner_acc + biases[1] + c.acc_sigma * rng.standard_normal(2),
            wheel_acc + c.acc_sigma * rng.standard_normal(2),
            corner - self._wheel + c.rattle_sigma * rng.standard_normal(2),
            self.pitch(t, 1) + biases[0] + c.gyro_sigma * rng.standard_normal(),
            speed + c.speed_sigma * rng.standard_normal(),
        )
