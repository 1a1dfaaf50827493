"""Grades and banks: J of each controller on a climbing road over its value on the same road made level.

`foreride table grades [--vehicle half] [--grades=-0.06,0.04] [--bank 0.03] [--controllers ...] [--json FILE]`

The road is of ISO 8608 class B with a bump and a pothole at its end. A vertical curve from 10 m on, or with
`--bank` a bank that rises over the same length, leads to the steady grade. A controller stands with its
perception, `mpc_preview@boxes`; `refused` are the steps in which the supervisor did not use a preview.
"""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from foreride.files.command_line import output_path
from foreride.files.errors import InputError, shown
from foreride.files.reading.numbers import within
from foreride.files.reading.ranges import MAX_SEED
from foreride.files.writing.atomic import write_text
from foreride.files.writing.targets import check_files
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.console import tracked
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.write import environment, to_json
from foreride.scenarios.tables.options import table_parser

CONTROLLERS = "passive,skyhook,mpc_reactive,mpc_preview@oracle,mpc_preview@boxes"
START_M, HALF_WIDTH_M = 10.0, 6.0
"""Start of the curve, and half the width of the banked road: beside a profile its border goes on level."""


class Slope(NamedTuple):
    """Result of one drive: grade and bank (m/m), J, its ratio to the level road's, steps refused."""

    vehicle: str
    controller: str
    grade: float
    bank: float
    objective: float
    ratio: float
    refused: int
    refused_on_level: int


def road_fields(length_m: float, curve_m: float, grade: float, bank_file: str | None) -> dict[str, Any]:
    """Overrides that put a climbing or banked road of this length into a scenario."""
    features = [
        {"kind": "half_sine_bump", "start_m": length_m - 35.0, "length_m": 0.5, "height_m": 0.05},
        {"kind": "pothole", "start_m": length_m - 15.0, "length_m": 0.6, "depth_m": 0.06, "width_m": 4.0},
    ]
    fields: dict[str, Any] = {"road.length_m": length_m, "road.features": features}
    if grade:
        change = {"start_m": START_M, "grade": grade, "length_m": curve_m}
        fields["road.grades"] = [change]
    return fields | ({"road.file": bank_file} if bank_file else {})


def banked_profile(length_m: float, curve_m: float, bank: float) -> str:
    """CSV of a road whose left side rises from START_M on over `curve_m` to the bank."""
    lines = [f"x_m,y={-HALF_WIDTH_M},y={HALF_WIDTH_M}"]
    for k in range(int(length_m / 0.25) + 1):
        share = min(max((0.25 * k - START_M) / curve_m, 0.0), 1.0)
        left_m = HALF_WIDTH_M * bank * share * share * (3.0 - 2.0 * share)
        lines.append(f"{0.25 * k:.2f},{-left_m:.6f},{left_m:.6f}")
    return "\n".join(lines) + "\n"


def drive(asked: Any, name: str, grade: float, bank_file: str | None) -> tuple[float, int]:
    """J of one drive, and the steps in which its preview was refused."""
    controller, _, perception = name.partition("@")
    fields = road_fields(asked.length_m, asked.curve_m, grade, bank_file)
    base = {"vehicle.model": asked.vehicle, "speed_kmh": asked.speed_kmh, "observer": asked.observer}
    run = simulate_case(Case(load("rough_b_80", base | fields), controller, perception or "none", asked.seed))
    reasons: dict[str, int] = run.solver.get("reasons") or {}
    refused = sum(count for reason, count in reasons.items() if reason.endswith("preview"))
    return run.metrics["objective"], refused


def slopes(asked: Any, grades: Sequence[float], folder: Path) -> list[Slope]:
    """Drive every controller over the level road and all others."""
    bank_file = None
    if asked.bank:
        bank_file = str(folder / "bank.csv")
        Path(bank_file).write_text(banked_profile(asked.length_m, asked.curve_m, asked.bank))
    done = []
    for name in tracked(asked.controllers.split(","), "grades"):
        level, level_refused = drive(asked, name, 0.0, None)
        for grade in grades:
            objective, refused = drive(asked, name, grade, bank_file)
            ratio = objective / level
            row = (asked.vehicle, name, grade, asked.bank, objective, ratio, refused, level_refused)
            done.append(Slope(*row))
    return done


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print the table, and write JSON if requested. Raises InputError."""
    parser = table_parser("grades", "controllers on grades and banks, relative to the level road")
    parser.add_argument("--vehicle", default="half", help="quarter, half or full (default half)")
    parser.add_argument("--controllers", default=CONTROLLERS, help=f"default {CONTROLLERS}")
    parser.add_argument("--grades", default="-0.06,0.04", help="m/m (default -0.06,0.04)")
    parser.add_argument("--bank", type=float, default=0.0, help="m/m (default 0)")
    parser.add_argument("--observer", choices=("sensors", "truth"), default="sensors")
    parser.add_argument("--speed-kmh", type=float, default=60.0, help="default 60")
    parser.add_argument("--length-m", type=float, default=240.0, help="of the road (default 240)")
    parser.add_argument("--curve-m", type=float, default=120.0, help="of the vertical curve (default 120)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=output_path, metavar="FILE", help="write all rows")
    asked = parser.parse_args(arguments)
    within("--seed", asked.seed, 0, MAX_SEED)
    check_files(asked.json)
    with TemporaryDirectory() as folder:
        done = slopes(asked, [_grade(text) for text in asked.grades.split(",")], Path(folder))
    print(f"\n{asked.vehicle} car, class B, {asked.speed_kmh:g} km/h, bank {asked.bank:g}\n")
    print("| controller | grade | J | J / level | refused | on the level |\n|---|---|---|---|---|---|")
    for one in done:
        numbers = f"{one.grade:+.0%} | {one.objective:.4f} | {one.ratio:.3f}"
        print(f"| {one.controller} | {numbers} | {one.refused} | {one.refused_on_level} |")
    if asked.json:
        rows = [one._asdict() for one in done]
        write_text(asked.json, to_json({"schema": 1, "manifest": environment(), "rows": rows}) + "\n")


def _grade(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"--grades: must be numbers in m/m, got {shown(text)}") from None
