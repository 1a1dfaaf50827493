"""Car identifier: body mass, damper strength and delay of the commands, from the body's balance of forces.

With the body's mass and the dampers' force as multiples m and d of the known ones, the body's acceleration is
that of the known springs times 1/m plus that of the known dampers times d/m. Least squares give both factors
for each of several delays of the commands, and the delay is that whose model explains the acceleration best
(a bank of models: D. T. Magill, Optimal adaptive estimation of sampled stochastic processes, IEEE Trans.
Autom. Control 10(4), 1965). All signals pass the same band: below it lie offsets of sensors and grades, above
it what bushings and noise add. Springs are taken as known, as the body's motion gives ratios alone.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from foreride.controller.identification.least_squares import LeastSquaresBank
from foreride.controller.interface import Identified
from foreride.files.jit import njit
from foreride.vehicle.load import Car

BAND_HZ = (0.5, 20.0)
MEMORY_S, CORRELATION_S = 30.0, 0.1
"""Time constant of forgetting, over excited samples alone, and time for each independent residual."""
PRIOR_SIGMA, MODEL_SIGMA = 0.3, 0.025
"""Standard deviations of the factors: before any data, and of what the model of the body leaves out."""
LEAST_ACC_M_S2, ARM_M = 0.15, 1.3
"""Least acceleration in the band that counts as excitation; lever arm that weighs rotations against heave."""
LEAST_SIGMA_M_S2 = 0.03
DELAY_STEP_S, LONGEST_DELAY_S = 0.005, 0.03
LIKELIHOOD = 10.0
"""Logarithm of the likelihood by which a delay must exceed that which is taken so far."""
LEAST_CHANGE, SIGMAS, GREATEST_SIGMA = 0.05, 3.0, 0.07
"""Change from which on a ratio is adopted: least, in standard deviations, and the greatest of those."""
UNEXPLAINED = 0.2
"""Greatest root mean square residual, relative to the acceleration, of a model that is adopted."""
BOUNDS = 0.5, 2.0
"""Least and greatest ratio."""
FIT_PERIOD_S = 0.05


class CarIdentifier:
    """Recursive identification; call `follow` and `update` once a period.

    present: ratios and delay as identified now. result: those adopted, as known at first; they change with a
    significant change alone.
    """

    def __init__(self, vehicle: Car, period_s: float) -> None:
        self._corners, self._mass = vehicle.corners, np.array(vehicle.generalised_mass)
        self._anti_roll = vehicle.anti_roll_n_m
        self._rows = np.array([corner.kinematic_row for corner in vehicle.corners])
        self._arms = np.array([1.0, *np.full(len(self._mass) - 1, ARM_M)])
        self._every_delay = max(round(DELAY_STEP_S / period_s), 1)
        self._step_s = self._every_delay * period_s
        self._delays = 1 + int(LONGEST_DELAY_S / self._step_s + 1e-9)
        self._gain = -np.expm1(-period_s / np.array([[corner.damper_lag_s] for corner in vehicle.corners]))
        self._slow, self._fast = (-np.expm1(-2.0 * np.pi * hz * period_s) for hz in BAND_HZ)
        self._passive = np.array([[corner.damping_passive_ns_m] for corner in vehicle.corners])
        self._bank = LeastSquaresBank(
            self._delays,
            np.ones(2),
            PRIOR_SIGMA,
            MEMORY_S / period_s * len(self._mass),
            CORRELATION_S / period_s,
            LEAST_SIGMA_M_S2,
        )
        self._every = max(round(FIT_PERIOD_S / period_s), 1)
        self.reset()

    def reset(self) -> None:
        """Return to the known car."""
        self._settings = np.repeat(self._passive, self._delays, axis=1)
        self._commands = np.repeat(self._passive, 1 + (self._delays - 1) * self._every_delay, axis=1)
        signals = len(self._mass), 2 + self._delays
        self._mean, self._band = np.zeros(signals), np.zeros(signals)
        self._excited = self._chosen = 0
        self._explained = False
        self._bank.reset()
        self.present = self.result = Identified()

    @property
    def settings(self) -> np.ndarray:
        """Present settings of the dampers (wheels,), N·s/m, at the adopted delay."""
        return self._settings[:, round(self.result.delay_s / self._step_s)]

    def follow(self, command: np.ndarray) -> None:
        """Take in the damper settings (wheels,) which act from the last period on at the known delay."""
        _follow(command, self._commands, self._every_delay, self._gain, self._settings)

    def update(self, acceleration: np.ndarray, travel: np.ndarray, rate: np.ndarray) -> None:
        """Compare the body's acceleration (body,) by springs and dampers with that of the known ones.

        travel, rate: (wheels,) of the suspensions, m and m/s.
        """
        forces = self._forces(travel.tolist(), rate.tolist())
        signals = acceleration, forces, self._rows, self._mass, self._arms
        if _filter(*signals, self._slow, self._fast, self._mean, self._band) < LEAST_ACC_M_S2:
            return
        output = self._band[:, 0]
        self._bank.add(output, _regressors(self._band))
        self._excited += 1
        if self._excited % self._every == 0:
            self._conclude()

    def _forces(self, travel: list[float], rate: list[float]) -> np.ndarray:
        """Forces (wheels, 1 + delays) on the body by the known springs and stops, and by the dampers."""
        forces = np.empty((len(self._corners), 1 + self._delays))
        for i, corner in enumerate(self._corners):
            extended, setting = travel[i], self._settings[i]
            jounce = max(-extended - corner.stop_gap_m, 0.0)
            rebound = max(extended - corner.rebound_gap_m, 0.0)
            stop = corner.stop_n_m2 * (jounce**2 - rebound**2)
            forces[i, 0] = corner.spring_force(extended, np) + stop
            normalised = corner.normalised_setting(setting)
            forces[i, 1:] = corner.damper.force(setting, normalised, extended, rate[i], [], np)
        for axle, stiffness in enumerate(self._anti_roll):
            left, right = 2 * axle, 2 * axle + 1
            twist = stiffness * (travel[left] - travel[right])
            forces[left, 0] -= twist
            forces[right, 0] += twist
        return forces

    def _conclude(self) -> None:
        fit = self._bank.fit()
        best = int(fit.residual.argmin())
        self._explained = bool(fit.residual[best] < UNEXPLAINED**2 * fit.output)
        if 0.5 * fit.independent * np.log(fit.residual[self._chosen] / fit.residual[best]) > LIKELIHOOD:
            self._chosen = best
        spring, damper = fit.parameters[self._chosen]
        covariance = fit.covariance[self._chosen] + MODEL_SIGMA**2 * np.eye(2)
        mass, strength = 1.0 / spring, damper / spring
        by_factors = np.array([[-(mass**2), 0.0], [-strength * mass, mass]])
        sigma = np.sqrt(np.diag(by_factors @ covariance @ by_factors.T))
        self.present = Identified(
            float(np.clip(mass, *BOUNDS)),
            float(np.clip(strength, *BOUNDS)),
            float(sigma[0]),
            float(sigma[1]),
            self._chosen * self._step_s,
        )
        self._adopt()

    def _adopt(self) -> None:
        """Adopt the present ratios and delay where they differ significantly from those adopted so far.

        A car that no model of the bank explains, such as one with slow valves, keeps what has been adopted.
        """
        if not self._explained:
            return
        now, before = self.present, self.result
        sigma = np.array([now.mass_sigma, now.damper_sigma])
        change = np.abs([now.mass - before.mass, now.damper - before.damper])
        certain = sigma.max() < GREATEST_SIGMA
        if certain and (change > np.maximum(LEAST_CHANGE, SIGMAS * sigma)).any():
            self.result = now
        elif now.delay_s != before.delay_s:
            self.result = replace(before, delay_s=now.delay_s)


@njit
def _follow(command: Any, commands: Any, every: int, gain: Any, settings: Any) -> None:
    """Put the command (wheels,) before the others (wheels, n); each delay's settings follow its own."""
    for wheel in range(len(command)):
        late = commands[wheel]
        for k in range(len(late) - 1, 0, -1):
            late[k] = late[k - 1]
        late[0] = command[wheel]
        for delay in range(settings.shape[1]):
            settings[wheel, delay] += gain[wheel, 0] * (late[delay * every] - settings[wheel, delay])


@njit
def _regressors(band: Any) -> Any:
    """Regressors (delays, body, 2), springs and dampers, of the filtered accelerations."""
    body, signals = band.shape
    out = np.empty((signals - 2, body, 2))
    for delay in range(signals - 2):
        for i in range(body):
            out[delay, i, 0], out[delay, i, 1] = band[i, 1], band[i, 2 + delay]
    return out


@njit
def _filter(
    acceleration: Any,
    forces: Any,
    kinematic_rows: Any,
    inertia: Any,
    arms: Any,
    slow: float,
    fast: float,
    mean: Any,
    band: Any,
) -> float:
    """Pass the acceleration (body,) and those by forces (wheels, n) through the band; return its greatest.

    mean, band: (body, 1 + n) states of the filters, in place.
    """
    greatest = 0.0
    for i in range(len(acceleration)):
        for k in range(mean.shape[1]):
            value = acceleration[i]
            if k > 0:
                value = 0.0
                for wheel in range(len(forces)):
                    value += kinematic_rows[wheel, i] * forces[wheel, k - 1]
                value /= inertia[i]
            value *= arms[i]
            mean[i, k] += slow * (value - mean[i, k])
            band[i, k] += fast * (value - mean[i, k] - band[i, k])
        greatest = max(greatest, abs(band[i, 0]))
    return greatest
