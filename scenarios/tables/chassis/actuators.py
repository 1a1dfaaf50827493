"""Actuators on random roads: semi-active, slow-active and fully active suspensions, and their energy.

`foreride table actuators --first 1000 --events 6 --json actuators.jsonl`. Each suspension is driven by the
reactive and the preview MPC, whose plan then holds the actuators' forces beside the dampers; values are
relative to the passive car. The power is what the actuators deliver to the car, positive parts only, before
any losses; what they absorb is not credited.
"""

from collections.abc import Sequence

import numpy as np

from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.random_roads.drives import lines
from foreride.scenarios.random_roads.results import Results, interval, mean
from foreride.scenarios.tables.options import parse_words, table_parser
from foreride.scenarios.tables.random_roads import add_random_options, controllers_of, driven
from foreride.scenarios.tables.runs import shown

SEMI_ACTIVE = "semi-active"
_KEY = "vehicle.parameters.actuator"
SUSPENSIONS: dict[str, tuple[str, ...]] = {
    SEMI_ACTIVE: (),
    "slow-active, 1.6 Hz, 3 kN": (f"{_KEY}={{kind: slow_active, lag_s: 0.1, force_limit_n: 3000}}",),
    "slow-active, 3.2 Hz, 3 kN": (f"{_KEY}={{kind: slow_active, lag_s: 0.05, force_limit_n: 3000}}",),
    "fully active, 32 Hz, 5 kN": (f"{_KEY}={{kind: fully_active, lag_s: 0.005, force_limit_n: 5000}}",),
}
"""Overrides of each suspension; the bandwidth is that of the force's first-order lag."""
_SHOWN = ("objective", "wk_rms", "tyre_load_rms", "rattle_rms")


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print the table, and keep the rows if requested. Raises InputError."""
    parser = table_parser("actuators", "semi-active, slow-active and fully active suspensions")
    add_random_options(parser, events=6, seeds="0", controllers="mpc_reactive,mpc_preview")
    parser.add_argument("--perceptions", default="oracle", help="of mpc_preview (default oracle)")
    asked = parser.parse_args(arguments)
    perceptions = parse_words("--perceptions", asked.perceptions, PERCEPTIONS.names())
    wanted = [line for name in SUSPENSIONS for line in lines(controllers_of(asked), perceptions, name)]
    overrides = {name: [*asked.overrides, *fields] for name, fields in SUSPENSIONS.items()}
    print("\n".join(actuator_table(driven(asked, wanted, overrides))))


def actuator_table(results: Results) -> list[str]:
    """A line for each suspension and controller: ride relative to passive, power in W."""
    table = ["| suspension | controller | J | Wk RMS | tyre load | travel | mean power, W | peak power, W |"]
    table.append("|---" * 8 + "|")
    for line, metrics in results.of_line.items():
        if line.controller == "passive":
            continue
        cells = [shown(interval(mean, results.relative(line, metric))) for metric in _SHOWN]
        for name in ("actuator_power", "actuator_power_peak"):
            cells.append(f"{np.mean(metrics[name]):.0f}" if name in metrics else "0")
        table.append(f"| {line.condition} | {line.name} | {' | '.join(cells)} |")
    return table
