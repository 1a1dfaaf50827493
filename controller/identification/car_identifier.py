"""Car identifier: body mass, damper strength and delay of the commands, from the body's balance of forces.

With the body's mass and the dampers' force as multiples m and d of the known ones, the body's acceleration is
that of the known springs times 1/m plus that of the known dampers times d/m. Least squares give both factors
for each of several delays of the commands, and the delay is that whose model explains the acceleration best
(a bank of models: D. T. Magill, Optimal adaptive estimation of sampled stochastic processes, IEEE Trans.
Autom. Control 10(4), 1965). All signals pass the same band: below it lie offsets of sensors and grades, above
it what bushings and noise add. Springs are taken as known, as the body's motion gives ratios alone.

Samples wait until a fit is due and are then taken in together, which gives the same results.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from foreride.controller.identification.least_squares import LeastSquaresBank
from foreride.controller.interface import Identified
from foreride.files.jit import copy_matrix, copy_vector, njit
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
WAITING = 50
"""Greatest number of samples that wait."""


class CarIdentifier:
    """Recursive identification; call `update` once a period, or `follow` where there are no signals.

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
        wheels = len(self._corners)
        self._signals = np.empty((WAITING, len(self._mass) + 2 * wheels))
        self._settings_then = np.empty((WAITING, wheels, self._delays))
        self._outputs = np.empty((WAITING, len(self._mass)))
        self.reset()

    def reset(self) -> None:
        """Return to the known car."""
        self._settings = np.repeat(self._passive, self._delays, axis=1)
        self._commands = np.repeat(self._passive, 1 + (self._delays - 1) * self._every_delay, axis=1)
        signals = len(self._mass), 2 + self._delays
        self._mean, self._band = np.zeros(signals), np.zeros(signals)
        self._excited = self._chosen = self._waiting = 0
        self._explained = False
        self._bank.reset()
        self.present = self.result = Identified()

    @property
    def settings(self) -> np.ndarray:
        """Present settings of the dampers (wheels,), N·s/m, at the adopted delay."""
        return self._settings[:, round(self.result.delay_s / self._step_s)].copy()

    def follow(self, command: np.ndarray) -> None:
        """Take in the damper settings (wheels,) which act from the last period on at the known delay."""
        _follow(command, self._commands, self._every_delay, self._gain, self._settings)

    def update(self, signals: np.ndarray, command: np.ndarray) -> None:
        """Compare the body's acceleration (body,) by springs and dampers with that of the known ones.

        signals: that acceleration, then travel and rate (wheels,) of the suspensions, m and m/s. command: as
        `follow` takes it in.
        """
        excited = _record(
            command,
            self._commands,
            self._every_delay,
            self._gain,
            self._settings,
            self._waiting,
            signals,
            self._arms,
            self._slow,
            self._fast,
            self._mean,
            self._band,
            self._signals,
            self._settings_then,
            self._outputs,
        )
        self._waiting, self._excited = self._waiting + 1, self._excited + excited
        due = excited and self._excited % self._every == 0
        if due or self._waiting == WAITING:
            self._take_in()
        if due:
            self._conclude()

    def _take_in(self) -> None:
        """Take in the samples that wait."""
        count, body, wheels = self._waiting, len(self._mass), len(self._corners)
        _, travel, rate = np.split(self._signals[:count], [body, body + wheels], axis=1)
        forces = self._forces(travel, rate, self._settings_then[:count])
        car, state = (self._rows, self._mass, self._arms), (self._mean, self._band)
        self._bank.add(*_samples(self._outputs, forces, *car, self._slow, self._fast, *state))
        self._waiting = 0

    def _forces(self, travel: np.ndarray, rate: np.ndarray, settings: np.ndarray) -> np.ndarray:
        """Forces (n, wheels, 1 + delays) on the body by the known springs and stops, and by the dampers.

        travel, rate: (n, wheels). settings: (n, wheels, delays).
        """
        forces = np.empty((len(travel), len(self._corners), 1 + self._delays))
        for i, corner in enumerate(self._corners):
            extended, setting = travel[:, i], settings[:, i]
            jounce = np.maximum(-extended - corner.stop_gap_m, 0.0)
            rebound = np.maximum(extended - corner.rebound_gap_m, 0.0)
            stop = corner.stop_n_m2 * (jounce**2 - rebound**2)
            forces[:, i, 0] = corner.spring_force(extended, np) + stop
            motion = extended[:, None], rate[:, i, None]
            normalised = corner.normalised_setting(setting)
            forces[:, i, 1:] = corner.damper.force(setting, normalised, *motion, [], np)
        for axle, stiffness in enumerate(self._anti_roll):
            left, right = 2 * axle, 2 * axle + 1
            twist = stiffness * (travel[:, left] - travel[:, right])
            forces[:, left, 0] -= twist
            forces[:, right, 0] += twist
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
def _record(
    command: Any,
    commands: Any,
    every: int,
    gain: Any,
    settings: Any,
    at: int,
    signals: Any,
    arms: Any,
    slow: float,
    fast: float,
    mean: Any,
    band: Any,
    kept_signals: Any,
    kept_settings: Any,
    outputs: Any,
) -> bool:
    """Follow the command and keep a sample in row `at`; return whether its acceleration in the band counts.

    outputs: (n, body) of the filters, NaN where it does not.
    """
    _follow(command, commands, every, gain, settings)
    greatest = 0.0
    copy_vector(signals, kept_signals[at])
    copy_matrix(settings, kept_settings[at])
    for i in range(len(arms)):
        outputs[at, i] = _passed(signals[i] * arms[i], slow, fast, mean, band, i, 0)
        greatest = max(greatest, abs(band[i, 0]))
    if greatest < LEAST_ACC_M_S2:
        outputs[at] = np.nan
        return False
    return True


@njit
def _samples(
    outputs: Any,
    forces: Any,
    kinematic_rows: Any,
    inertia: Any,
    arms: Any,
    slow: float,
    fast: float,
    mean: Any,
    band: Any,
) -> Any:
    """Outputs (n, body) and regressors (n, delays, body, 2) of the samples that count.

    The accelerations by the forces (samples, wheels, 1 + delays) are filtered by the states mean and band.
    """
    body, delays, count = len(arms), forces.shape[2] - 1, 0
    counted, regressors = np.empty((len(forces), body)), np.empty((len(forces), delays, body, 2))
    for sample in range(len(forces)):
        for i in range(body):
            for k in range(1 + delays):
                value = 0.0
                for wheel in range(forces.shape[1]):
                    value += kinematic_rows[wheel, i] * forces[sample, wheel, k]
                _passed(value / inertia[i] * arms[i], slow, fast, mean, band, i, 1 + k)
        if not np.isnan(outputs[sample, 0]):
            for i in range(body):
                counted[count, i] = outputs[sample, i]
                for delay in range(delays):
                    regressors[count, delay, i, 0] = band[i, 1]
                    regressors[count, delay, i, 1] = band[i, 2 + delay]
            count += 1
    return counted[:count], regressors[:count]


@njit
def _passed(value: float, slow: float, fast: float, mean: Any, band: Any, row: int, column: int) -> float:
    """A signal's next value behind the high pass and the low pass, whose states stand in row and column."""
    mean[row, column] += slow * (value - mean[row, column])
    band[row, column] += fast * (value - mean[row, column] - band[row, column])
    return float(band[row, column])
