"""Sensors on random roads: the comfort that `mpc_preview` gains by map, stereo camera, LiDAR and camera.

`foreride table sensors --events 40 --json rows.jsonl`. The same events, options and file of rows as
`foreride table random_roads`; each sensor drives the same roads with the same controller. The map is a survey
of the event's road (`scenarios.random_roads.survey_map`).
"""

from collections.abc import Sequence

import numpy as np

from foreride.scenarios.perceptions.registry import PERCEPTIONS, perception_entry
from foreride.scenarios.random_roads.drives import Line, lines
from foreride.scenarios.random_roads.results import Results, interval, mean, share_kept, worse
from foreride.scenarios.tables.options import parse_words, table_parser
from foreride.scenarios.tables.random_roads import ORACLE, add_random_options, controllers_of, driven
from foreride.scenarios.tables.runs import shown

REFERENCE = Line("mpc_reactive", "none")
SENSORS = "oracle,map,stereo_30cm,lidar_64,lidar_solid_state,boxes,camera"


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print the table, and keep the rows if requested. Raises InputError."""
    parser = table_parser("sensors", "what each sensor of the road ahead is worth")
    add_random_options(parser, events=40, seeds="0", controllers="mpc_reactive,mpc_preview")
    parser.add_argument("--perceptions", default=SENSORS, help=f"of mpc_preview (default {SENSORS})")
    asked = parser.parse_args(arguments)
    perceptions = parse_words("--perceptions", asked.perceptions, PERCEPTIONS.names())
    print(
        "\n".join(
            sensor_table(driven(asked, lines(controllers_of(asked), perceptions), {"": asked.overrides}))
        )
    )


def sensor_table(results: Results) -> list[str]:
    """Each sensor: objective and ride relative to the passive car, and the gain over no preview."""
    heads = "J / passive", "Wk RMS / passive", f"gain kept over {REFERENCE.name}", "worse by > 1 %"
    table = [f"| preview | {' | '.join(heads)} |", "|---|---|---|---|---|"]
    for line in results.of_line:
        if line != REFERENCE and line.controller != "mpc_preview":
            continue
        name = perception_entry(line.perception).label if line != REFERENCE else "none (`mpc_reactive`)"
        ratios = [shown(interval(mean, results.relative(line, metric))) for metric in ("objective", "wk_rms")]
        table.append(f"| {name} | {' | '.join([*ratios, *_against_reference(results, line)])} |")
    return table


def _against_reference(results: Results, line: Line) -> tuple[str, str]:
    """Share of the oracle's gain over the reference, and number of events that are worse than it."""
    if line == REFERENCE or not {REFERENCE, ORACLE} <= set(results.of_line):
        return "-", "-"
    reference, achieved, perfect = (results.relative(one) for one in (REFERENCE, line, ORACLE))
    kept = shown(interval(share_kept, reference, achieved, perfect), ".0%")
    return kept, f"{worse(np.asarray(achieved), reference)} of {len(results.events)}"
