"""All controllers on the reporting set, and the gain of the MPCs over the best tuned reactive law.

`foreride table rivals` runs all of them; `--controllers` fewer. Gains are means over the events
of 1 − (value / value of the best law), where the best law is the one with the smallest J relative to passive
on these very events.
"""

from collections.abc import Sequence

import numpy as np

from foreride.controller.tuned_settings import TUNED_CONTROLLERS
from foreride.files.writing.targets import check_files
from foreride.scenarios.definition.sets import load_all
from foreride.scenarios.tables.options import selected_overrides, shared_parser, whole_numbers
from foreride.scenarios.tables.runs import Variant, mean_over_events, metric, run_all, shown, write

MPCS = ("mpc_reactive", "mpc_wheelbase", "mpc_preview")


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print the table, and write JSON if requested. Raises InputError."""
    parser = shared_parser("rivals", "controllers on the reporting set", seeds="0,1,2")
    parser.add_argument("--controllers", default=",".join([*TUNED_CONTROLLERS, *MPCS]))
    asked = parser.parse_args(arguments)
    check_files(asked.json)
    scenarios = load_all(asked.events, selected_overrides(asked))
    names = [
        name for name in asked.controllers.split(",") if asked.vehicle != "quarter" or name != "mpc_wheelbase"
    ]
    variants = [
        Variant(name, name, "oracle" if name == "mpc_preview" else "none", scenarios)
        for name in ["passive", *names]
    ]
    done = run_all(variants, whole_numbers("--seeds", asked.seeds), asked.read)
    print(f"\n{asked.vehicle} car, {len(scenarios)} events, seeds {asked.seeds}\n")
    print("| controller | J / passive | Wk RMS / passive | VDV / passive | lift ms | stops ms |")
    print("|---|---|---|---|---|---|")
    relative = {}
    for name, runs in done.items():
        cells = []
        for value in ("objective", "wk_rms", "vdv"):
            ratio = metric(runs, value) / metric(done["passive"], value)
            cells.append(shown(mean_over_events(ratio)))
            relative[name, value] = ratio
        cells += [
            shown(mean_over_events(1e3 * metric(runs, value)), ".1f") for value in ("lift_time", "stop_time")
        ]
        print(f"| {name} | {' | '.join(cells)} |")
    laws = [name for name in names if name not in MPCS]
    if laws:
        best = min(laws, key=lambda name: float(relative[name, "objective"].mean()))
        print(f"\nGain over {best}, the best of the reactive laws on these events\n")
        print("| controller | J | Wk RMS | VDV | events better in J |\n|---|---|---|---|---|")
        for name in (name for name in names if name in MPCS):
            gains = {
                v: 1.0 - metric(done[name], v) / metric(done[best], v) for v in ("objective", "wk_rms", "vdv")
            }
            cells = [shown(mean_over_events(gain), ".1%") for gain in gains.values()]
            better = int(np.sum(gains["objective"].mean(axis=0) > 0.0))
            print(f"| {name} | {' | '.join(cells)} | {better} of {len(scenarios)} |")
    write(asked.json, done)
