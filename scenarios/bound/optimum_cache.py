"""Clairvoyant bound of a scenario: the optimal plan for the whole drive, cached."""

import hashlib
import io
from contextlib import suppress
from dataclasses import replace

import numpy as np

from foreride.controller.clairvoyant.optimum import Optimum, optimise
from foreride.controller.clairvoyant.single_shooting import DriveInputs, WholeDriveObjective
from foreride.controller.command_limits import KILO
from foreride.controller.tuned_settings import settings_for
from foreride.files.cache import cached
from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_bytes
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.clock import TICKS_PER_SECOND, due, ticks
from foreride.scenarios.definition.oracle_errors import OracleErrors
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.simulation.simulate import simulate
from foreride.scenarios.simulation.wheel_profiles import wheel_profiles
from foreride.vehicle.equations import input_size
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.speed_profile import ConstantSpeed, SpeedProfile
from foreride.vehicle.state import road_under

START_CONTROLLERS = ("passive", "skyhook", "mpc_preview")
"""Controllers whose commands serve as starting points of the optimisation."""


def bound(scenario: Scenario) -> Optimum:
    """Return the optimal plan for the scenario's whole drive, from the cache if available.

    It knows the simulated car (`plant` included), with valves that follow their command at once. A cached
    plan is accepted only if it still yields the J stored with it.
    """
    if scenario.vehicle.fmu:
        raise InputError(
            f"{scenario.name}: the bound needs the car's equations, which vehicle.fmu does not give"
        )
    car, drive = scenario.true_car, drive_inputs(scenario)
    objective = WholeDriveObjective(car, drive)
    path = cached(f"bounds/{_key(scenario, drive)}.npz")
    try:
        cached_optimum = _read(path.read_bytes(), objective)
    except OSError:
        cached_optimum = None
    if cached_optimum is not None:
        return cached_optimum
    first_ticks = np.searchsorted(drive.interval, np.arange(objective.intervals))
    plans = {}
    for name in START_CONTROLLERS:
        plans[name] = _commands(_start_case(scenario, name))[:, first_ticks].T / KILO
    optimum = optimise(car, objective, plans)
    with suppress(OSError):  # a bound that cannot be cached is still valid
        write_bytes(path, _bytes(optimum))
    return optimum


def drive_inputs(scenario: Scenario) -> DriveInputs:
    """External inputs of the scenario's drive, for `controller.clairvoyant.single_shooting`."""
    scenario.require_given_speed("the bound")
    car, control, count = scenario.true_car, scenario.control, scenario.ticks
    profiles = wheel_profiles(scenario)
    plant = Plant(car)
    grade = scenario.road.grade(scenario.start_m)
    plant.reset(profiles, scenario.start_m, scenario.motion, grade)
    motion = scenario.motion
    course = motion if isinstance(motion, SpeedProfile) else ConstantSpeed(motion)
    stretch = course.ahead(scenario.start_m, 0, count)
    height, velocity = road_under(car, profiles, stretch.edges_m, stretch.speed_m_s)
    mid_height, _ = road_under(car, profiles, stretch.middles_m, 0.0)
    constant_speed = stretch.forward_acc is None
    delay_ticks = ticks(control.delay_s + scenario.plant.actuation_delay_s)
    sampled = [tick >= delay_ticks and due(tick - delay_ticks, control.rate_hz) for tick in range(count)]
    return DriveInputs(
        rate_hz=TICKS_PER_SECOND,
        height=np.array(height),
        velocity=np.array(velocity),
        mid_height=np.array(mid_height),
        forward_acc=np.zeros(count + 1) if constant_speed else np.asarray(stretch.forward_acc),
        surge=np.zeros(count) if constant_speed else np.diff(stretch.speed_m_s) * TICKS_PER_SECOND,
        interval=np.cumsum(sampled) - 1,
        start=np.array(plant.state.x),
        rho=scenario.tyre_load_weight,
    )


def _start_case(scenario: Scenario, controller: str) -> Case:
    """Fault-free case with exact states, the true road ahead and shipped settings, as a starting point.

    It depends only on what enters `_key`: a cached result must not depend on the caller's settings.
    """
    settings = settings_for(scenario.vehicle.parameters)
    clear = replace(
        scenario,
        observer="truth",
        faults=(),
        oracle=OracleErrors(),
        control=replace(scenario.control, settings=settings),
    )
    return Case(clear, controller, "oracle" if controller == "mpc_preview" else "none", scenario.seed)


def _commands(case: Case) -> np.ndarray:
    """Simulate a case; return the command during each tick, (inputs, ticks), N·s/m and N."""
    signals, car = simulate(case).signals, case.scenario.vehicle.parameters
    names = [f"{kind}_{wheel}" for kind in ("command", "force_command") for wheel in range(car.wheels)]
    return np.array([signals[name][1:] for name in names[: input_size(car)]])


def _key(scenario: Scenario, drive: DriveInputs) -> str:
    """Cache key: hash of everything that determines the bound, i.e. the car and its external inputs."""
    hasher = hashlib.sha256(repr(scenario.true_car).encode())
    hasher.update(repr((drive.rate_hz, drive.rho)).encode())
    for array in (drive.height, drive.velocity, drive.mid_height, drive.surge, drive.interval, drive.start):
        hasher.update(np.ascontiguousarray(array).tobytes())
    return hasher.hexdigest()


def _bytes(optimum: Optimum) -> bytes:
    stream = io.BytesIO()
    names, values = np.array(list(optimum.objectives)), np.array(list(optimum.objectives.values()))
    np.savez_compressed(stream, plan=optimum.plan, names=names, values=values)
    return stream.getvalue()


def _read(data: bytes, drive_objective: WholeDriveObjective) -> Optimum | None:
    """Parse a cached optimum; None if it is damaged or outdated."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            plan, names, values = archive["plan"], archive["names"], archive["values"]
    except Exception:  # zip and npy readers raise many things on damaged data
        return None
    if (
        plan.shape != (drive_objective.intervals, drive_objective.inputs)
        or not len(values)
        or len(names) != len(values)
    ):
        return None
    value, _ = drive_objective.objective(plan)
    if not np.isclose(value, values.min(), rtol=1e-9):
        return None
    return Optimum(plan, value, dict(zip(names.tolist(), values.tolist(), strict=True)))
