"""Validation of the vehicle models: statics, frequency responses, transients, energy, dampers."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import control
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from foreride.scenarios.validation.check import Check, Checks, relative
from foreride.vehicle import equations
from foreride.vehicle.clock import RATE_HZ, STEP_S
from foreride.vehicle.dampers.damper import Damper, MrBoucWenDamper, MrTanhDamper, ValveDamper
from foreride.vehicle.linear_model import linear_twin
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plant.fleet import Fleet
from foreride.vehicle.plant.mujoco_engine import RolloutEngine
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.speed_profile import SpeedProfile
from foreride.vehicle.state import VehicleState, observe, road_under

Array = NDArray[np.float64]
SPEED_M_S = 9.0
TICKS = 1200


@dataclass(frozen=True)
class Haversine:
    """Haversine bump: one period of 1 - cos."""

    height_m: float
    length_m: float
    start_m: float = 2.0

    def height(self, x: Array) -> Array:
        """Height at x, m."""
        return self.height_m / 2 * (1.0 - np.cos(2 * np.pi * self._inside(x)))

    def slope(self, x: Array) -> Array:
        """Derivative of the height at x."""
        return self.height_m * np.pi / self.length_m * np.sin(2 * np.pi * self._inside(x))

    def _inside(self, x: Array) -> Array:
        return np.clip((x - self.start_m) / self.length_m, 0.0, 1.0)


HARSH = Haversine(0.16, 1.2)
GENTLE = Haversine(0.02, 2.0)


def drive(car: Car, bump: Haversine, damping: float, x_m: float = 0.0) -> VehicleState:
    """Simulate the plant over the same bump on both sides."""
    plant = Plant(car)
    plant.reset([bump] * car.wheels, x_m, SPEED_M_S)
    plant.step(np.full(car.wheels, damping), TICKS)
    return plant.signals


def integrate(car: Car, bump: Haversine, damping: float, method: str = "RK45") -> VehicleState:
    """Integrate the equations over the exact road by SciPy's adaptive integrators."""
    command, time = np.full(car.wheels, damping), np.arange(TICKS + 1) / RATE_HZ
    profiles, asked = [bump] * car.wheels, command.tolist()

    def slope(t: float, x: Array) -> list[float]:
        road = road_under(car, profiles, SPEED_M_S * t, SPEED_M_S)
        return equations.derivative(car, x.tolist(), asked, *road, equations.FLOATS)

    start = equations.rest_state(car)
    x = solve_ivp(slope, (0, time[-1]), start, method, t_eval=time, rtol=1e-8, atol=1e-10, max_step=2e-3).y
    commands, speeds = np.tile(command[:, None], len(time)), np.full(len(time), SPEED_M_S)
    road = road_under(car, profiles, SPEED_M_S * time, SPEED_M_S)
    return observe(car, time, SPEED_M_S * time, speeds, x, commands, road)


def summary(signals: VehicleState) -> Array:
    """RMS and peak of body acceleration, rattle and tyre load, and the dampers' work."""
    load = signals.tyre_force / signals.static_tyre_force - 1.0
    values = [
        statistic
        for signal in (signals.body_acc, signals.rattle_m, load)
        for statistic in (np.sqrt(np.mean(signal**2)), np.abs(signal).max())
    ]
    return np.array([*values, np.sum(signals.damper_force * signals.rattle_velocity)])


def _one_tick(car: Car) -> tuple[Array, Array]:
    """State and input matrices of a tick at passive damping, by finite differences of the engine."""
    engine, wheels = RolloutEngine(car), car.wheels
    moving = 2 * (len(car.generalised_mass) + wheels)
    rest = np.zeros(engine.size)
    rest[engine.order] = equations.rest_state(car)
    held = np.zeros((1, 2 * wheels + (wheels > 1)))
    held[0, :wheels] = [corner.damping_passive_ns_m for corner in car.corners]

    def after(row: Array, control_row: Array) -> Array:
        return engine.advance(row, control_row, np.empty((1, engine.size)))[engine.order][:moving]

    state, drive_in = np.zeros((moving, moving)), np.zeros((moving, wheels))
    for j in range(moving):
        pushed = rest.copy()
        pushed[engine.order[j]] = 1e-3
        state[:, j] = after(pushed, held) / 1e-3
    for j in range(wheels):
        pushed = held.copy()
        pushed[0, wheels + j] = 10.0
        drive_in[:, j] = after(rest, pushed) / 10.0
    return state, drive_in


def _frequency_response(name: str) -> Check:
    """Matrices of a tick against python-control's exact discretisation of the twin, at a held tyre force."""
    car = load_vehicle(name)
    twin = linear_twin(car)
    per_newton = twin.B[:, : car.wheels] / [corner.tyre_n_m for corner in car.corners]
    exact = control.c2d(control.ss(twin.A, per_newton, twin.C, 0), STEP_S, "zoh")
    ours = control.ss(*_one_tick(car), twin.C, 0, STEP_S)
    omega = 2 * np.pi * np.geomspace(0.1, 30.0, 60)
    found, expected = (np.asarray(system(np.exp(1j * omega * STEP_S))) for system in (ours, exact))
    scale = np.abs(expected).max(axis=2, keepdims=True)
    deviation = float((np.abs(found - expected) / np.maximum(np.abs(expected), 1e-2 * scale)).max())
    return Check(f"{name} car, frequency response to 30 Hz", "python-control, same hold", deviation, 1e-4)


def _poles(name: str) -> Check:
    car = load_vehicle(name)
    found = np.sort_complex(np.log(np.linalg.eigvals(_one_tick(car)[0]) + 0j) / STEP_S)
    expected = np.sort_complex(linear_twin(car).poles())
    deviation = float(np.abs(found - expected).max() / np.abs(expected).max())
    return Check(f"{name} car, natural frequencies and damping ratios", "python-control", deviation, 1e-4)


def _bump(name: str) -> Check:
    car = load_vehicle(name)
    deviation = relative(summary(drive(car, HARSH, 300.0)), summary(integrate(car, HARSH, 300.0)))
    return Check(f"{name} car, bump with stops and lift-off", "scipy solve_ivp, rtol 1e-8", deviation, 5e-3)


def _uneven() -> Check:
    """Cubic springs, and a rebound stop closer than the jounce stop."""
    car = replace(load_vehicle("quarter"), spring_n_m3=1.5e6, rebound_gap_m=0.05)
    deviation = relative(summary(drive(car, HARSH, 300.0)), summary(integrate(car, HARSH, 300.0)))
    return Check("progressive spring, uneven stops, bump", "scipy solve_ivp, rtol 1e-8", deviation, 5e-3)


def _damper(part: Damper) -> Check:
    car = replace(load_vehicle("quarter"), damper=part)
    truth = integrate(car, HARSH, 2500.0, "LSODA")
    deviation = relative(summary(drive(car, HARSH, 2500.0)), summary(truth))
    return Check(f"{part.kind} damper, bump", "scipy solve_ivp, rtol 1e-8", deviation, 5e-3)


def _energy(name: str) -> Check:
    """Work of the road = stored energy + heat of dampers and tyres."""
    car = load_vehicle(name)
    signals = drive(car, GENTLE, 1500.0)
    state = equations.motion(car, signals.x)
    stored, heat, work = np.zeros(TICKS + 1), np.zeros(TICKS + 1), np.zeros(TICKS + 1)
    for inertia, velocity in zip(car.generalised_mass, state.body_velocity, strict=True):
        stored += inertia * velocity**2 / 2
    for i, corner in enumerate(car.corners):
        stretch = signals.road_height[i] - state.wheel[i]
        rate = signals.road_velocity[i] - state.wheel_velocity[i]
        stored += corner.unsprung_mass_kg * state.wheel_velocity[i] ** 2 / 2
        stored += corner.spring_n_m * signals.rattle_m[i] ** 2 / 2 + corner.tyre_n_m * stretch**2 / 2
        heat += -signals.damper_force[i] * signals.rattle_velocity[i] + corner.tyre_damping_ns_m * rate**2
        work += (signals.tyre_force[i] - corner.static_tyre_n) * signals.road_velocity[i]
    spent, given = (np.trapezoid(power) * STEP_S for power in (heat, work))
    turned_over = np.trapezoid(np.abs(work)) * STEP_S
    deviation = abs(stored[-1] + spent - given) / turned_over
    return Check(f"{name} car, energy balance over a bump", "closed balance", float(deviation), 1e-3)


def _static_deflection() -> Check:
    """Pitch under steady braking: springs and tyres in series balance the moment m·a·h."""
    car = load_vehicle("half")
    plant = Plant(car)
    flat = Haversine(0.0, 1.0)
    plant.reset([flat] * 2, 0.0, SpeedProfile((0.0, 12.0), (40.0, 4.0)))
    plant.step([4500.0, 4500.0], 9000)
    series = [1 / (1 / corner.spring_n_m + 1 / corner.tyre_n_m) for corner in car.corners]
    k = np.array([[s * a * b for a in (1.0, -c.x_m) for b in (1.0, -c.x_m)]
                  for s, c in zip(series, car.corners, strict=True)]).sum(axis=0).reshape(2, 2)  # fmt: skip
    heave, pitch = np.linalg.solve(k, [0.0, car.generalised_mass[0] * 3.0 * car.inertial_lever_arm_m[1]])
    now = plant.state
    return Check("static heave and pitch at 3 m/s² of braking", "closed form",
                 relative([now.heave_m, now.pitch_rad], [heave, pitch]), 1e-4)  # fmt: skip


def _halves() -> Check:
    half, full = (drive(load_vehicle(name), HARSH, 1500.0) for name in ("half", "full"))
    error = np.abs(full.tyre_force[::2] - half.tyre_force).max() / half.static_tyre_force.max()
    return Check("full car on equal tracks, tyre loads", "half car", float(error), 1e-6)


def _quarters() -> Check:
    """Half car with pitch inertia m·a·b, whose axles are decoupled, against two quarter cars."""
    mass, front, rear = 800.0, 1.25, 1.45
    car = replace(load_vehicle("half"), pitch_inertia_kg_m2=mass * front * rear)
    both, deviation = drive(car, HARSH, 1500.0), 0.0
    for i, share in enumerate((rear, front)):
        quarter = replace(load_vehicle("quarter"), sprung_mass_kg=mass * share / (front + rear))
        one = drive(quarter, HARSH, 1500.0, x_m=car.axle_x_m[i])
        error = np.abs(both.tyre_force[i] - one.tyre_force[0]).max()
        deviation = max(deviation, float(error / one.static_tyre_force.max()))
    return Check("half car of decoupled inertia, tyre loads", "two quarter cars", deviation, 1e-6)


def _fleet() -> Check:
    """Different cars stepped together on two threads, each against the plant."""
    cars = [replace(load_vehicle("half"), body_mass_kg=600.0 + 5.0 * i) for i in range(64)]
    commands, deviation = np.full((64, 2), 1500.0), 0.0
    states = Fleet(cars, threads=2).drive([HARSH] * 2, 0.0, SPEED_M_S, commands, TICKS)
    for i in (0, 31, 63):
        deviation = max(deviation, float(np.abs(states[i].T - drive(cars[i], HARSH, 1500.0).x).max()))
    return Check("64 cars at once on two threads, states", "one car at a time", deviation, 0.0, "m, m/s")


def _each(check: Callable[[str], Check]) -> Checks:
    return tuple(partial(check, name) for name in ("quarter", "half", "full"))


CHECKS: Checks = (
    _static_deflection,
    *_each(_poles),
    *_each(_frequency_response),
    *_each(_bump),
    _uneven,
    *(partial(_damper, part) for part in (ValveDamper(), MrTanhDamper(), MrBoucWenDamper())),
    *_each(_energy),
    _halves,
    _quarters,
    _fleet,
)
