"""Robustness: controllers on random roads with a car, valves and sensors that differ from what they know.

`foreride table robustness --first 1000 --events 20 --jobs 2 --json rows.jsonl`. Every value is J relative to
the passive car in the same condition, with a 95 % interval of a bootstrap over events and seeds; the last
columns are `mpc_preview` relative to `mpc_reactive`. The file of rows can be continued, as that of
`random_roads`.
"""

from collections.abc import Sequence

from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.random_roads.conditions import CONDITIONS
from foreride.scenarios.random_roads.drives import Line, lines
from foreride.scenarios.random_roads.results import Array, Results, interval, mean
from foreride.scenarios.tables.options import parse_words, table_parser
from foreride.scenarios.tables.random_roads import add_random_options, controllers_of, driven
from foreride.scenarios.tables.runs import shown

_REACTIVE = "mpc_reactive"


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print the table, and keep the rows if requested. Raises InputError."""
    parser = table_parser("robustness", "controllers on cars that differ from what they know")
    add_random_options(parser, events=20, seeds="0")
    parser.add_argument("--perceptions", default="oracle", help="of mpc_preview (default oracle)")
    listed = "; ".join(CONDITIONS)
    parser.add_argument("--conditions", default=listed, help="separated by semicolons (default all)")
    asked = parser.parse_args(arguments)
    conditions = parse_words("--conditions", asked.conditions, list(CONDITIONS), "; ")
    perceptions = parse_words("--perceptions", asked.perceptions, PERCEPTIONS.names())
    controllers = controllers_of(asked)
    wanted = [line for name in conditions for line in lines(controllers, perceptions, name)]
    overrides = {name: [*asked.overrides, *CONDITIONS[name]] for name in conditions}
    print("\n".join(robustness_table(driven(asked, wanted, overrides), conditions)))


def robustness_table(results: Results, conditions: Sequence[str]) -> list[str]:
    """One row per condition, one column per controller, then preview over reactive."""
    first = [line for line in results.of_line if line.condition == conditions[0]]
    active = [line for line in first if line.controller != "passive"]
    previews = [line for line in active if line.controller == "mpc_preview"]
    compared = previews if any(line.controller == _REACTIVE for line in active) else []
    heads = [line.name for line in active] + [f"{line.name} / {_REACTIVE}" for line in compared]
    table = [f"| condition | {' | '.join(heads)} |", "|---" * (len(heads) + 1) + "|"]
    for name in conditions:
        cells = [shown(interval(mean, results.relative(line._replace(condition=name)))) for line in active]
        for line in compared:
            rival = results.relative(Line(_REACTIVE, "none", name))
            preview = results.relative(line._replace(condition=name))
            cells.append(shown(interval(_ratio_of_means, preview, rival)))
        table.append(f"| {name} | {' | '.join(cells)} |")
    return table


def _ratio_of_means(values: Array, rival: Array) -> float:
    return float(values.mean() / rival.mean())
