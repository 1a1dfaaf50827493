"""Kinematic Kalman filter: corner and wheel motion from the car's own sensors, with its covariance.

Measured accelerations drive double integrators, so stiffness, damping and bump stops play no part. Suspension
travel, pitch rate and roll rate correct them. Two pseudo-measurements complete them: the road's plane seldom
accelerates, which tells a vertical curve from an offset of the accelerometers, and the corners of a rigid
body that outnumber its motions stay in one plane, without warp (an equality constraint as a nearly perfect
measurement: D. Simon, Kalman filtering with state equality constraints, IEEE Trans. Aerosp. Electron. Syst.
38(1), 2002).

The covariance is that of the errors relative to the frame which the same road, known exactly, would have:
the frame follows the estimated road, so it follows an error of the estimate too.
"""

from dataclasses import dataclass

import numpy as np

from foreride.controller.observer.filter_layout import filter_layout, gyros
from foreride.controller.observer.filter_model import filter_model
from foreride.controller.observer.filter_steps import corrected, predicted, readings, reframed, taken_in
from foreride.controller.observer.observer_steps import follow_motion
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import SensorNoise

ALIASING = 0.06
"""Standard deviation of a period's mean acceleration per second difference of its samples.

Between the samples an acceleration may run as it likes; the second difference measures how it does. Random
events, half car: 0.04 to 0.08 make the innovations of the travel consistent.
"""

CAUSE_SIGMA_M_S2 = 0.025
"""Standard deviation of the mean of the first balances of forces."""
CURVE_SPEED_M_S, STANDING_SHARE = 5.0, 0.03
"""Speed below which the road's plane accelerates less, and the least share."""


@dataclass(frozen=True, eq=False)
class Claim:
    """State with its covariance; innovation and its covariance for the reading that was last taken in."""

    state: np.ndarray
    covariance: np.ndarray
    innovation: np.ndarray
    innovation_covariance: np.ndarray


class KinematicFilter:
    """Extended state of a car on a moving frame with its covariance: see `filter_layout`, `filter_model`."""

    def __init__(self, vehicle: Car, noise: SensorNoise, period_s: float) -> None:
        self.model, self.rows = filter_model(vehicle, noise, period_s), filter_layout(vehicle)
        self.reset()

    def reset(self) -> None:
        """Start from rest on the road's plane."""
        self.state, self.covariance = np.zeros(self.rows.size), self.model.start.copy()
        readings = len(self.model.output)
        self.innovation, self.innovation_covariance = np.zeros(readings), np.eye(readings)
        self._samples, self._begun = np.zeros((3, self.model.drive.shape[1])), False
        rows = self.rows
        self._struts = np.empty(rows.plane_rate.stop - rows.plane_rate.start + rows.body_velocity.start)

    def follow(
        self,
        channels: np.ndarray,
        plane_motion: np.ndarray,
        speed_m_s: float,
        body_of_corners: np.ndarray,
        inertial: np.ndarray,
        forward_acc: float,
    ) -> np.ndarray:
        """Take in a complete reading of the sensors; the motion of the caller's plane is corrected.

        Does what `predict`, `readings` and `correct` do one by one. Returns what `strut_motion` writes.
        """
        model = self.model
        follow_motion(
            self.state,
            self.covariance,
            self.innovation,
            self.innovation_covariance,
            self._samples,
            self._begun,
            channels,
            gyros(self.rows.wheel.start),
            ALIASING,
            model.transition,
            model.drive,
            model.process,
            model.output,
            model.acceleration_variance,
            self.reading_variance(speed_m_s),
            plane_motion,
            speed_m_s,
            body_of_corners,
            inertial,
            forward_acc,
            self._struts,
        )
        self._begun = True
        return self._struts

    def predict(self, acceleration: np.ndarray, variance: np.ndarray) -> None:
        """Move on to this sample (2w,) of the accelerations; the first sample only begins.

        The mean over a period is that of the parabola through its two samples and the one before
        (Adams-Moulton).
        """
        samples, model = self._samples, self.model
        if not self._begun:
            samples[:], self._begun = acceleration, True
            return
        samples[2], samples[1], samples[0] = samples[1], samples[0], acceleration
        before, motion = (self.state, self.covariance), (model.transition, model.drive, model.process)
        self.state, self.covariance = predicted(*before, samples, variance, ALIASING, *motion)

    def reading_variance(self, speed_m_s: float) -> np.ndarray:
        """Variance of a reading of sound sensors, not to be changed.

        A plane under a standing car does not accelerate.
        """
        if speed_m_s >= CURVE_SPEED_M_S:
            return self.model.reading_variance
        variance = self.model.reading_variance.copy()
        variance[self.rows.curve_reading] *= max(speed_m_s / CURVE_SPEED_M_S, STANDING_SHARE) ** 2
        return variance

    def readings(self, channels: np.ndarray, plane_motion: np.ndarray) -> np.ndarray:
        """Readings of the filter from the sensors' channels and the motion of its caller's plane."""
        wheels = self.rows.wheel.start
        counts = wheels, gyros(wheels)
        return np.asarray(readings(channels, *counts, plane_motion, len(self.model.output)))

    def correct(self, reading: np.ndarray, variance: np.ndarray) -> np.ndarray:
        """Take in a reading; return the corrections to the plane, which the caller's plane takes over."""
        step = corrected(self.state, self.covariance, self.model.output, reading, variance)
        self.state, self.covariance, self.innovation, self.innovation_covariance = step
        return self._corrections()

    def unspecified(self) -> np.ndarray:
        """Acceleration (body,) in the balance of forces that offsets and zero errors are found to cause.

        In standard deviations of what sensors that are as specified cause.
        """
        rows, balance = self.rows, self.model.balance
        causes = np.hstack([balance[:, rows.offset], -balance[:, rows.body]])
        found = np.concatenate([self.state[rows.offset], self.state[rows.zero_error]])
        specified = self.model.specified_variance
        variance = causes**2 @ np.concatenate([specified[rows.offset], specified[rows.zero_error]])
        return causes @ found / np.sqrt(variance + CAUSE_SIGMA_M_S2**2)

    def confirm(self) -> np.ndarray:
        """Believe offsets and zero errors to be as specified; returns corrections as `correct` does.

        A prior of lesser variance is one more independent measurement of zero.
        """
        specified, rows = self.model.specified_variance, self.rows
        wheels = rows.wheel.stop - rows.wheel.start
        body = np.arange(rows.offset.start, rows.offset.start + wheels)
        chosen = np.concatenate([body, np.arange(rows.zero_error.start, rows.zero_error.stop)])
        believed = np.diag(self.model.start)[chosen]
        variance = 1.0 / (1.0 / specified[chosen] - 1.0 / believed)
        self._update(np.eye(rows.size)[chosen], -self.state[chosen], variance)
        return self._corrections()

    def _update(self, output: np.ndarray, innovation: np.ndarray, variance: np.ndarray) -> None:
        self.state, self.covariance = taken_in(self.state, self.covariance, output, innovation, variance)

    def _corrections(self) -> np.ndarray:
        corrections = self.state[self.rows.plane].copy()
        self.state[self.rows.plane] = 0.0
        return corrections

    def move_frame(
        self, change: np.ndarray, follows: bool, faster: float, deflection_variance: np.ndarray
    ) -> None:
        """Change the frame's velocity by `change` (wheels,), as it has followed the road or not.

        faster: relative change of the speed; deflection_variance: (wheels,) of the tyre deflections.
        """
        model, own = self.model, (self.state, self.covariance)
        frame = model.frame[follows], model.faster, faster, model.frame_drive[follows]
        self.covariance = reframed(*own, change, *frame, deflection_variance)
