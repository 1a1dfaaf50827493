"""Comfort budget: cost of each error source relative to the gain of a perfect preview.

`foreride table budget [--events SCENARIO ...] [--vehicle half] [--seeds 0,1,2] [--json FILE]`

The whole chain (rendered image, detector, estimator, observer, latency, solver in its real-time setting) is
simulated with `mpc_preview`; then one source at a time is replaced by the truth. The reference gain is that
of `mpc_preview` with the true road ahead and the true state over `mpc_reactive` with its default settings.

    cost of a source = (J of the whole chain - J with this source true) / (J reactive - J all true)

so 0.05 means: without this error, an additional 5 % of the possible gain would be kept. Costs need not add up
to the loss of the whole chain, because errors mask one another; `rest` is the difference. J is relative to
passive.

JSON: {"schema": 1, "manifest": {...}, "vehicle": "half", "seeds": [0, ...], "events": ["hump_flat_30", ...],
       "table": [{"event": "hump_flat_30" | "mean",
                  "reactive": J, "whole": J, "all_true": J, "kept": share of the gain that the chain keeps,
                  "rest": share,
                  "sources": [{"source": "detector" | "distance" | "shape" | "latency" | "observer" |
                               "solver", "replaced_by": "exact boxes of all objects in sight",
                               "objective": J with it true, "cost": share of the gain}, ...]}, ...]}

Every J is the mean over the seeds. In the row "mean" each J is the mean over the events, and kept, rest and
cost are ratios of these means, not means of the events' ratios. If "all true" gains nothing over reactive,
ratios to the gain are undefined, and kept, rest and cost are null.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from foreride.files.writing.atomic import write_text
from foreride.files.writing.targets import check_files
from foreride.scenarios.definition.sets import load_all
from foreride.scenarios.runs.write import environment, to_json
from foreride.scenarios.tables.options import selected_overrides, shared_parser, whole_numbers
from foreride.scenarios.tables.runs import Variant, metric, run_all

EXACT_BOXES = {
    "boxes": {"pixel_sigma": 0, "miss_probability": 0, "min_height_px": 0},
    **{f"{block}.{edge}_bias_px": [0, 0] for block in ("boxes", "estimator") for edge in ("bottom", "top")},
}
LONG_PLAN = {"control.settings.mpc": {"horizon_s": 0.6, "fine_s": 0.6}}
SOURCES: dict[str, tuple[str, str, dict[str, Any]]] = {
    "detector": ("exact boxes of all objects in sight", "boxes", EXACT_BOXES),
    "distance": ("the true near edge of what was found", "camera", {"told": ["distance"]}),
    "shape": ("the true kind, length and height of what was found", "camera", {"told": ["shape"]}),
    "latency": ("boxes at the moment of exposure", "camera", {"camera.latency_s": 0}),
    "observer": ("the true state of the car", "camera", {"observer": "truth"}),
    "solver": ("a plan of which each period is planned", "camera", LONG_PLAN),
}
"""Error sources: description of the replacement, perception, and overridden fields."""
EVENTS = ["hump_flat_30", "pothole_60x8_40", "bump_8x40_30"]


def table(done: dict[str, np.ndarray], events: list[str]) -> list[dict]:
    """One row per event and one of their means; `done`: J over passive of each line, (seeds, events)."""
    mean = {name: values.mean(axis=0) for name, values in done.items()}
    rows = [
        _row(event, {name: float(values[k]) for name, values in mean.items()})
        for k, event in enumerate(events)
    ]
    return [*rows, _row("mean", {name: float(values.mean()) for name, values in mean.items()})]


def _row(event: str, j: dict[str, float]) -> dict:
    gain = j["reactive"] - j["all_true"]

    def share(difference: float) -> float | None:
        return difference / gain if gain > 0.0 else None

    costs = {name: j["whole"] - j[name] for name in SOURCES}
    lost = j["whole"] - j["all_true"]
    return {
        "event": event,
        **{name: j[name] for name in ("reactive", "whole", "all_true")},
        "kept": share(gain - lost),
        "rest": share(lost - sum(costs.values())),
        "sources": [
            {"source": name, "replaced_by": by, "objective": j[name], "cost": share(costs[name])}
            for name, (by, _, _) in SOURCES.items()
        ],
    }


def _told(share: float | None, style: str) -> str:
    return "-" if share is None else format(share, style)


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print the table, and write JSON if requested. Raises InputError."""
    parser = shared_parser("budget", "what each source of error costs", seeds="0,1,2")
    parser.set_defaults(events=EVENTS)
    asked = parser.parse_args(arguments)
    check_files(asked.json)
    if asked.read:
        parser.error("--read: a budget is driven in one piece")
    plain = load_all(asked.events, selected_overrides(asked))
    exact = load_all(asked.events, selected_overrides(asked, {"observer": "truth"} | LONG_PLAN))
    variants = [
        Variant("passive", "passive", "none", plain),
        Variant("reactive", "mpc_reactive", "none", plain),
        Variant("all_true", "mpc_preview", "oracle", exact),
        Variant("whole", "mpc_preview", "camera", plain),
    ]
    for name, (_, perception, fields) in SOURCES.items():
        replaced = load_all(asked.events, selected_overrides(asked, fields))
        variants.append(Variant(name, "mpc_preview", perception, replaced))
    seeds = whole_numbers("--seeds", asked.seeds)
    done = {name: metric(rows, "objective") for name, rows in run_all(variants, seeds).items()}
    passive = done.pop("passive")
    rows = table({name: values / passive for name, values in done.items()}, [one.name for one in plain])
    print(f"\n{asked.vehicle} car, seeds {asked.seeds}; J / passive, and share of the possible gain\n")
    print(f"| event | reactive | camera | all true | kept | {' | '.join(SOURCES)} | rest |")
    print("|---" * (6 + len(SOURCES)) + "|")
    for row in rows:
        cells = [f"{row[name]:.3f}" for name in ("reactive", "whole", "all_true")] + [
            _told(row["kept"], ".0%")
        ]
        cells += [_told(cost, "+.1%") for cost in (*(s["cost"] for s in row["sources"]), row["rest"])]
        print(f"| {row['event']} | {' | '.join(cells)} |")
    if asked.json:
        names = {"vehicle": asked.vehicle, "seeds": seeds, "events": [one.name for one in plain]}
        document = {"schema": 1, "manifest": environment(), **names, "table": rows}
        write_text(asked.json, to_json(document) + "\n")
