"""Measurement and drawing of the documentation's figures: `python -m docs.figures [measure|draw]`.

`measure` drives everything and keeps the numbers in figures/physics.json; `draw` makes the figures of them.
"""

import argparse
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from foreride.files.writing.atomic import write_text
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.report.figures.drive import drive_figure
from foreride.scenarios.report.figures.files import save
from foreride.scenarios.report.palette import CONTROLLER_COLOURS

FOLDER = Path(__file__).parent / "figures"
NUMBERS = FOLDER / "physics.json"
NOTHING: Mapping[str, Any] = {}
BASE = {"vehicle.model": "quarter", "observer": "truth"}
EVENTS = (
    "bump_8x40_30", "bump_10x50_20", "hump_watts_30", "hump_flat_30",
    "pothole_30x5_50", "pothole_60x8_40", "pothole_80x10_60", "rough_b_80", "mixed_40",
)  # fmt: skip
CONTROLLERS = ("skyhook", "mpc_reactive", "mpc_preview")
STUDIED = ("hump_flat_30", "pothole_60x8_40")
SWEEPS: dict[str, tuple[float, ...]] = {
    "oracle.bias_m": (-0.6, -0.4, -0.2, -0.1, 0.0, 0.1, 0.2, 0.4, 0.6),
    "oracle.height_gain": (0.0, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0),
    "control.settings.mpc.horizon_s": (0.03, 0.05, 0.1, 0.15, 0.2, 0.3, 0.6),
}
TITLES = {
    "oracle.bias_m": "obstacle believed farther ahead by (m)",
    "oracle.height_gain": "believed over true height",
    "control.settings.mpc.horizon_s": "length of the plan (s)",
}
TRACED = ("passive", "mpc_reactive", "mpc_preview")


def measure() -> None:
    """Drive all events and sweeps on the quarter car with exact states; J relative to the passive car."""
    events = {name: {law: _ratio(name, law) for law in CONTROLLERS} for name in EVENTS}
    sweeps = {
        field: {name: [_ratio(name, "mpc_preview", {field: value}) for value in values] for name in STUDIED}
        for field, values in SWEEPS.items()
    }
    write_text(NUMBERS, json.dumps({"events": events, "sweeps": sweeps}, indent=1) + "\n")
    runs = [simulate_case(_case("hump_flat_30", law, NOTHING)) for law in TRACED]
    save(drive_figure(runs), FOLDER / "hump.png")


def draw() -> None:
    """Make the figures from the numbers."""
    numbers = json.loads(NUMBERS.read_text())
    _draw_events(numbers["events"])
    _draw_sweeps(numbers["sweeps"], numbers["events"])


def _case(name: str, law: str, overrides: Mapping[str, Any]) -> Case:
    return Case(load(name, BASE | dict(overrides)), law, "oracle" if law == "mpc_preview" else "none", 0)


_passive: dict[str, float] = {}


def _ratio(name: str, law: str, overrides: Mapping[str, Any] = NOTHING) -> float:
    if name not in _passive:
        _passive[name] = simulate_case(_case(name, "passive", NOTHING)).metrics["objective"]
    ratio = simulate_case(_case(name, law, overrides)).metrics["objective"] / _passive[name]
    print(f"{name} {law} {dict(overrides)} {ratio:.3f}", flush=True)
    return round(ratio, 4)


def _draw_events(events: dict[str, dict[str, float]]) -> None:
    figure = Figure(figsize=(8, 4.4), layout="constrained")
    axis = figure.subplots()
    for row, ratios in enumerate(events.values()):
        axis.plot([min(ratios.values()), max(ratios.values())], [row, row], color="#d5d8db", lw=5, zorder=1)
        for law in CONTROLLERS:
            label = law.replace("mpc_", "MPC, ") if row == 0 else None
            axis.scatter(ratios[law], row, s=60, color=CONTROLLER_COLOURS[law], label=label, zorder=2)
    axis.axvline(1.0, color=CONTROLLER_COLOURS["passive"], lw=1.2)
    axis.text(1.005, -0.7, "passive", fontsize=8, color=CONTROLLER_COLOURS["passive"])
    axis.set_yticks(range(len(events)), [load(name).title for name in events], fontsize=9)
    axis.invert_yaxis()
    axis.set_xlim(0.1, 1.1)
    axis.set_xlabel("objective J relative to the passive car (less is better)")
    _plain(axis)
    figure.legend(fontsize=9, loc="outside lower center", ncols=3, frameon=False)
    save(figure, FOLDER / "events.png")


def _draw_sweeps(sweeps: dict[str, dict[str, list[float]]], events: dict[str, dict[str, float]]) -> None:
    figure = Figure(figsize=(10, 3.6), layout="constrained")
    axes = figure.subplots(1, len(sweeps), sharey=True)
    colours: dict[str, Any] = dict(zip(STUDIED, ("#1c6ebe", "#b0413e"), strict=True))
    for axis, (field, curves) in zip(axes, sweeps.items(), strict=True):
        for name, ratios in curves.items():
            axis.plot(SWEEPS[field], ratios, "o-", color=colours[name], ms=4, label=load(name).title)
            axis.axhline(events[name]["mpc_reactive"], color=colours[name], lw=1, ls="--")
        axis.set_xlabel(TITLES[field])
        _plain(axis)
    axes[0].set_ylabel("J relative to passive")
    axes[0].set_ylim(0, None)
    axes[-1].legend(fontsize=8, frameon=False, title="dashed: reactive MPC", title_fontsize=8)
    save(figure, FOLDER / "knowledge.png")


def _plain(axis: Axes) -> None:
    axis.grid(alpha=0.25)
    axis.spines[["top", "right"]].set_visible(False)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("step", nargs="?", choices=("measure", "draw"), help="default: both, in this order")
    step = parser.parse_args().step
    if step in (None, "measure"):
        measure()
    if step in (None, "draw"):
        draw()


if __name__ == "__main__":
    main()
