"""Proving-ground bumps of Theunissen et al.: ride of passive cars and the effect of control.

`foreride table proving_ground [--vehicles half,suv] [--seed 0] [--json FILE]`

J. Theunissen et al., Regionless explicit model predictive control of active suspension systems with preview,
IEEE Trans. Industrial Electronics 67(6), 2020, evaluate ride by heave and pitch acceleration below 4 Hz, the
primary ride. It is given here beside the Wk-weighted RMS at the seats: RMS over the whole drive of the
content below 4 Hz, by Parseval's theorem. Each car is also simulated with slow-active actuators in parallel
with its dampers, because the car of the paper has hydraulic actuators.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from foreride.files.command_line import output_path
from foreride.files.reading.numbers import within
from foreride.files.reading.ranges import MAX_SEED
from foreride.files.writing.atomic import write_text
from foreride.files.writing.targets import check_files
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.write import environment, to_json
from foreride.scenarios.tables.options import table_parser

BUMPS = ("theunissen_5x40_30", "theunissen_15x250_50")
PRIMARY_RIDE_HZ = 4.0
LADDER = (("passive", "none"), ("skyhook", "none"), ("mpc_reactive", "none"), ("mpc_preview", "oracle"))
ACTIVE = {"vehicle.parameters.actuator": {"kind": "slow_active"}}


class Ride(NamedTuple):
    """Result of one drive: Wk RMS and peak at the seats, heave (m/s²) and pitch (rad/s²) RMS below 4 Hz."""

    vehicle: str
    actuator: bool
    bump: str
    controller: str
    wk_rms: float
    peak_acc: float
    heave: float
    pitch: float


def primary_ride(acceleration: NDArray[np.float64]) -> float:
    """RMS below 4 Hz of an acceleration sampled at every tick."""
    spectrum = np.fft.rfft(acceleration) / len(acceleration)
    below = np.fft.rfftfreq(len(acceleration), 1.0 / TICKS_PER_SECOND) < PRIMARY_RIDE_HZ
    power = 2.0 * np.abs(spectrum[below]) ** 2
    power[0] /= 2.0
    return float(np.sqrt(power.sum()))


def drive(vehicle: str, actuator: bool, bump: str, controller: str, perception: str, seed: int) -> Ride:
    """Simulate one car over one bump."""
    scenario = load(bump, {"vehicle.model": vehicle} | (ACTIVE if actuator else {}))
    run = simulate_case(Case(scenario, controller, perception, seed))
    heave, pitch = (primary_ride(run.signals[name]) for name in ("cg_acc", "pitch_acc"))
    metrics = run.metrics["wk_rms"], run.metrics["peak_acc"]
    return Ride(vehicle, actuator, bump, controller, *metrics, heave, pitch)


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print the table, and write JSON if requested. Raises InputError."""
    parser = table_parser("proving_ground", "rides over the proving-ground bumps of Theunissen et al.")
    parser.add_argument("--vehicles", default="half,suv")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=output_path)
    asked = parser.parse_args(arguments)
    within("--seed", asked.seed, 0, MAX_SEED)
    check_files(asked.json)
    rides = []
    print("| car | bump | controller | Wk RMS | peak | heave < 4 Hz | pitch < 4 Hz |")
    print("|---|---|---|---|---|---|---|")
    for vehicle in asked.vehicles.split(","):
        for actuator in (False, True):
            for bump in BUMPS:
                for controller, perception in LADDER[2 if actuator else 0 :]:
                    ride = drive(vehicle, actuator, bump, controller, perception, asked.seed)
                    car = f"{vehicle}, slow-active" if actuator else vehicle
                    numbers = f"{ride.wk_rms:.3f} | {ride.peak_acc:.2f} | {ride.heave:.3f} | {ride.pitch:.3f}"
                    print(f"| {car} | {bump} | {controller} | {numbers} |", flush=True)
                    rides.append(ride._asdict())
    if asked.json:
        write_text(asked.json, to_json({"schema": 1, "manifest": environment(), "rides": rides}) + "\n")
