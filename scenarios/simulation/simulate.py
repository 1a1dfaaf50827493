"""Multirate closed-loop simulation: plant at 1 kHz, controller and camera at their own rates."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from foreride.comfort.metrics import ride_metrics
from foreride.comfort.registry import added_metrics
from foreride.controller.interface import MonitoredController
from foreride.files.errors import InputError
from foreride.files.fmi.foreign import FmuFailed
from foreride.preview.prior_drives.memory_file import Memory
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.definition.random_streams import random_stream
from foreride.scenarios.perceptions.interface import Drive, Event, Exposure, Perception
from foreride.scenarios.perceptions.registry import perception_entry
from foreride.scenarios.simulation.fault_injection import Faults
from foreride.scenarios.simulation.multirate_loop import MultirateLoop
from foreride.scenarios.simulation.observer_errors import observer_errors
from foreride.scenarios.simulation.plants import build_plant
from foreride.scenarios.simulation.preview_log import PreviewLog, collect
from foreride.scenarios.simulation.recorded_signals import RecordedSignals
from foreride.scenarios.simulation.referenced_files import hashes
from foreride.scenarios.simulation.wheel_profiles import wheel_profiles
from foreride.vehicle.energy_audit import energy_audit
from foreride.vehicle.load import control_model
from foreride.vehicle.plant.difference import DeliveredReadings
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.plant.sensors import Sensors
from foreride.vehicle.state import VehicleState


@dataclass(frozen=True)
class Run:
    """Results of one run.

    signals: one value per tick under each name; per-wheel names end in `_0`, `_1`, ... (front, rear or
        front left, front right, rear left, rear right).
    metrics: the ride metrics (see `comfort.metrics`). events: detections and fallbacks in order of time.
    observer: RMS errors of its states (see `scenarios.simulation.observer_errors`).
    solver, perception_stats: counts and qualities; timing: run times on this machine.
    files_sha256: hashes of the files that the case names beside its road (see
    `scenarios.simulation.referenced_files`). track_y_m: lateral position of the right wheels. looks:
    exposures, with images if requested. previews: record of the previews given to the controller.
    memory: the estimator's map for the next drive, if any. bound: passive and clairvoyant objective (see
        `scenarios.bound.headroom`), if requested. failed: why the drive ended early, if it did.
    """

    case: Case
    signals: Mapping[str, np.ndarray]
    metrics: dict[str, float]
    events: list[Event]
    solver: dict[str, Any]
    observer: dict[str, float]
    perception_stats: dict[str, Any]
    timing: dict[str, float]
    files_sha256: dict[str, str | None]
    track_y_m: float
    looks: list[Exposure]
    previews: PreviewLog
    memory: Memory | None = None
    bound: dict[str, float] | None = None
    failed: str | None = None


class DriveFailed(InputError):
    """Failure of a drive on its way; `run` holds what was driven, with the reason in `run.failed`."""

    run: Run


def simulate(
    case: Case,
    keep_images: bool = False,
    advance: Callable[[int], None] = lambda ticks: None,
    controller: MonitoredController | None = None,
) -> Run:
    """Simulate one case; `advance` is called with every number of completed ticks (for progress bars).

    Without `controller`, the one that the case names is built.

    Raises DriveFailed if a step of the car's FMU fails; its run has the metrics of the part driven, if it is
    long enough for them.

    The same case on the same platform gives the same signals and metrics, bit for bit; only `timing` differs.
    """
    started = perf_counter()
    car = case.scenario.vehicle.parameters
    loop, plant, perception = assembled(case, keep_images, controller)
    files_sha256 = hashes(case)
    failed = None
    try:
        loop.drive(advance)
    except FmuFailed as error:
        failed = f"{error} at {plant.state.time_s:.3f} s"
    finally:
        perception.close()
    signals = RecordedSignals(plant)
    wall_s = perf_counter() - started
    timing = {"wall_s": wall_s, "real_time_factor": plant.state.time_s / wall_s}
    run = Run(
        case=case,
        signals=signals,
        metrics=metrics_of(signals, case) if failed is None else _metrics_of_part(signals, case),
        events=loop.events,
        solver=loop.solver,
        observer=observer_errors(control_model(car), loop.estimates, signals),
        perception_stats=perception.stats(),
        timing=timing | loop.timing | perception.timing(),
        files_sha256=files_sha256,
        track_y_m=min(car.wheel_y_m),
        looks=perception.looks,
        previews=collect(loop.seen),
        memory=perception.memory() if failed is None else None,
        failed=failed,
    )
    if failed is not None:
        error_of_drive = DriveFailed(f"{case.scenario.name} {case.controller}: {failed}")
        error_of_drive.run = run
        raise error_of_drive
    return run


def assembled(
    case: Case, keep_images: bool = False, controller: MonitoredController | None = None
) -> tuple[MultirateLoop, Plant, Perception]:
    """Loop of a case before its first tick, with its plant and its perception, which must be closed."""
    scenario, car = case.scenario, case.scenario.vehicle.parameters
    profiles = wheel_profiles(scenario)
    plant = build_plant(scenario)
    grade = scenario.road.grade(scenario.start_m)
    plant.reset(profiles, scenario.start_m, scenario.motion, grade)
    sensors = Sensors(car.wheels, random_stream(case.seed, "sensors"), scenario.sensors)
    delivered = DeliveredReadings(sensors, scenario.plant, car.wheels)
    perception = perception_entry(case.perception).build(Drive(scenario, profiles, case.seed, keep_images))
    faults = Faults(scenario.faults, random_stream(case.seed, "faults"))
    return MultirateLoop(case, plant, delivered, perception, faults, controller), plant, perception


def metrics_of(signals: RecordedSignals, case: Case) -> dict[str, float]:
    """Ride metrics of a recorded drive, with its energy audit (`vehicle.energy_audit`) and added metrics."""
    car = case.scenario.true_car
    ride = ride_metrics(
        TICKS_PER_SECOND,
        **signals.whole(_ride_signals),
        static_tyre_force=next(signals.parts()).static_tyre_force[:, 0],
        stop_gap_m=np.array([corner.stop_gap_m for corner in car.corners]),
        rebound_gap_m=np.array([corner.rebound_gap_m for corner in car.corners]),
        rho=case.scenario.tyre_load_weight,
    )
    own = ride | energy_audit(car, **signals.whole(_audited_signals))
    added = added_metrics(signals, TICKS_PER_SECOND)
    if taken := own.keys() & added.keys():
        raise InputError(f"metric {min(taken)}: the name is taken by foreride")
    return own | added


def _ride_signals(part: VehicleState) -> dict[str, np.ndarray]:
    return {
        "seat_acc": part.seat_acc,
        "rattle": part.rattle_m,
        "tyre_force": part.tyre_force,
        "damper_power": -part.damper_force * part.rattle_velocity,
        "pitch_acc": part.pitch_acc,
        "roll_acc": part.roll_acc,
    }


def _audited_signals(part: VehicleState) -> dict[str, np.ndarray]:
    names = "damper_force", "rattle_velocity", "damping", "actuator_force"
    return {name: getattr(part, name) for name in names}


def _metrics_of_part(signals: RecordedSignals, case: Case) -> dict[str, float]:
    """Ride metrics of a drive that ended early; none if it is too short for them."""
    try:
        return metrics_of(signals, case)
    except ValueError:  # filters and windows need some length
        return {}
