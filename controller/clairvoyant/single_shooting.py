"""Single shooting over a whole drive: the objective J and its gradient, on the exact plant model.

The model is `vehicle.equations`, integrated tick by tick as in the plant; J is that of `comfort.metrics`,
including its weighting filter. The gradient comes from one backward sweep (adjoint method): as the filter is
linear and starts at rest, its adjoint is the same filter run backwards.
"""

from dataclasses import dataclass

import casadi
import numpy as np

from foreride.comfort.weighting import weight
from foreride.controller.command_limits import KILO
from foreride.controller.prediction.casadi_llvm import CompiledFunction
from foreride.controller.prediction.prediction_model import SIMD_LANES
from foreride.files.jit import njit
from foreride.vehicle import equations
from foreride.vehicle.load import Car


@dataclass(frozen=True, eq=False)
class DriveInputs:
    """External inputs of a drive, by tick.

    height, velocity: (wheels, ticks + 1) of the road under the wheels at each tick.
    mid_height: (wheels, ticks) height midway between two ticks.
    forward_acc: (ticks + 1,) longitudinal acceleration of the car at each tick, m/s².
    surge: (ticks,) the same, averaged over each tick.
    interval: (ticks,) index of the command acting during each tick; -1 while the dampers are still passive.
    start: (states,) initial state. rho: weight of the tyre load in J, (m/s²)².
    """

    rate_hz: float
    height: np.ndarray
    velocity: np.ndarray
    mid_height: np.ndarray
    forward_acc: np.ndarray
    surge: np.ndarray
    interval: np.ndarray
    start: np.ndarray
    rho: float


class WholeDriveObjective:
    """Objective J and its gradient for plans (intervals, inputs): settings, kN·s/m, then forces, kN."""

    def __init__(self, vehicle: Car, drive: DriveInputs):
        self._vehicle, self._drive = vehicle, drive
        self.inputs = equations.input_size(vehicle)
        self.intervals = int(drive.interval.max()) + 1
        step, slopes = _functions(vehicle, 1.0 / drive.rate_hz)
        self._n_x, self._ticks = equations.state_size(vehicle), len(drive.interval)
        self._points = self._external_inputs()
        linearise = CompiledFunction(slopes, SIMD_LANES)
        self._results = np.zeros((linearise.rows_out, self._points.shape[1]))
        self._advance = CompiledFunction(step).bind(self._points, self._points[:, 1:], self._ticks)
        self._linearise = linearise.bind(self._points, self._results, self._points.shape[1])
        triplets = [np.array(slopes.sparsity_out(matrix + 1).get_triplet()) for matrix in range(3)]
        self._entries = np.vstack([np.insert(pair.T, 0, i, axis=1) for i, pair in enumerate(triplets)])
        self._passive = np.zeros(self.inputs)
        self._passive[: vehicle.wheels] = [c.damping_passive_ns_m / KILO for c in vehicle.corners]

    def _external_inputs(self) -> np.ndarray:
        """Input columns of the compiled functions, one per tick, with the external inputs filled in."""
        drive, ticks = self._drive, self._ticks
        rows = [
            np.zeros((self._n_x + self.inputs, ticks + 1)),
            np.pad(drive.mid_height, ((0, 0), (0, 1))),
            np.pad(np.diff(drive.height, axis=1) * drive.rate_hz, ((0, 0), (0, 1))),
            np.pad(drive.surge, (0, 1))[None],
            drive.height,
            drive.velocity,
            drive.forward_acc[None],
        ]
        points = np.vstack(rows)
        points[: self._n_x, 0] = drive.start
        return np.ascontiguousarray(np.pad(points, ((0, 0), (0, -(ticks + 1) % SIMD_LANES))))

    def objective(self, plan: np.ndarray) -> tuple[float, np.ndarray]:
        """J and dJ/dplan, both for `plan` (intervals, inputs) or flat, kN·s/m and kN."""
        commands = np.vstack([plan.reshape(-1, self.inputs), self._passive])  # row -1: passive
        drive, n = self._drive, self._ticks + 1
        self._points[self._n_x : self._n_x + self.inputs, : self._ticks] = commands[drive.interval].T
        self._advance()
        self._linearise()
        seat_count = len(self._vehicle.seat_kinematic_rows)
        outputs = self._results[: seat_count + self._vehicle.wheels, :n]
        seats, loads = outputs[:seat_count], outputs[seat_count:]
        weighted = weight(seats, drive.rate_hz, "Wk")
        j = float(np.mean(weighted**2) + drive.rho * np.mean(loads**2))
        adjoint = weight(weighted[:, ::-1], drive.rate_hz, "Wk")[:, ::-1]
        slopes = np.vstack([2.0 / seats.size * adjoint, 2.0 * drive.rho / loads.size * loads])
        gradient = np.zeros_like(commands)
        _adjoint_sweep(self._results, self._entries, slopes, drive.interval, self._n_x, gradient)
        return j, gradient[:-1].reshape(plan.shape)


def _functions(vehicle: Car, tick_s: float) -> tuple[casadi.Function, casadi.Function]:
    """CasADi functions of one tick: next state; outputs and sparse Jacobians."""
    x = casadi.SX.sym("x", equations.state_size(vehicle))
    u = casadi.SX.sym("u", equations.input_size(vehicle))
    mid_height, rate, height, velocity = (casadi.SX.sym(name, vehicle.wheels) for name in "mrhv")
    surge, forward = casadi.SX.sym("surge"), casadi.SX.sym("forward")
    next_state = _tick(vehicle, x, u, mid_height, rate, surge, tick_s)
    forces = equations.forces(vehicle, x, height, velocity, casadi)
    body, _ = equations.accelerations(vehicle, forces, forward)
    seats = [equations.point_motion(kinematic_row, body) for kinematic_row in vehicle.seat_kinematic_rows]
    static = casadi.DM([corner.static_tyre_n for corner in vehicle.corners])
    outputs = casadi.vertcat(*seats, forces.tyre / static - 1)
    inputs = [x, u, mid_height, rate, surge, height, velocity, forward]
    slopes = [
        outputs,
        casadi.jacobian(next_state, x),
        casadi.jacobian(next_state, u),
        casadi.jacobian(outputs, x),
    ]
    return (
        casadi.Function("tick", inputs, [next_state], {"cse": True}),
        casadi.Function("slopes", inputs, slopes, {"cse": True}),
    )


def _tick(
    vehicle: Car,
    x: casadi.SX,
    u: casadi.SX,
    mid_height: casadi.SX,
    rate: casadi.SX,
    surge: casadi.SX,
    tick_s: float,
) -> casadi.SX:
    """Classical Runge–Kutta step with the road of the tick's middle, in the substeps the damper needs."""

    def rates(state: casadi.SX) -> casadi.SX:
        return equations.derivative(vehicle, state, KILO * u, mid_height, rate, casadi, surge)

    substeps = vehicle.corners[0].damper.substeps
    h = tick_s / substeps
    for _ in range(substeps):
        k1 = rates(x)
        k2 = rates(x + h / 2 * k1)
        k3 = rates(x + h / 2 * k2)
        k4 = rates(x + h * k3)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return x


@njit()
def _adjoint_sweep(
    results: np.ndarray,
    entries: np.ndarray,
    slopes: np.ndarray,
    interval: np.ndarray,
    states: int,
    gradient: np.ndarray,
) -> None:
    """Add to `gradient` (intervals + 1, inputs) the sensitivity of J to each command (adjoint sweep).

    results: outputs, then the entries of dx⁺/dx, dx⁺/du, d outputs/dx, one column per tick. slopes: dJ/d
    outputs.
    """
    outputs, ticks = len(slopes), len(interval)
    costate, previous_costate = np.zeros(states), np.zeros(states)
    for tick in range(ticks, -1, -1):
        previous_costate[:] = 0.0
        for e in range(len(entries)):
            matrix, row, column = entries[e]
            value = results[outputs + e, tick]
            if matrix == 2:
                previous_costate[column] += value * slopes[row, tick]
            elif tick < ticks:
                if matrix == 0:
                    previous_costate[column] += value * costate[row]
                else:
                    gradient[interval[tick], column] += value * costate[row]
        costate, previous_costate = previous_costate, costate
