"""Pareto fronts of comfort against tyre load against suspension travel on random roads, `foreride front`."""

import argparse
from pathlib import Path

from foreride.scenarios.commands.console import console
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.random_roads.fronts import Array, efficient, front_lines, hypervolume, points
from foreride.scenarios.report.figures.files import save
from foreride.scenarios.report.figures.fronts import fronts_figure
from foreride.scenarios.tables.options import parse_words
from foreride.scenarios.tables.random_roads import add_random_options, controllers_of, driven

_DEFAULT = "skyhook,hybrid,lqr_clipped,mpc_reactive,mpc_wheelbase,mpc_preview"


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    add_random_options(command, events=20, seeds="0", controllers=_DEFAULT)
    command.add_argument("--perceptions", default="oracle", help="of mpc_preview (default oracle)")
    command.add_argument("--limits", action="store_true", help="MPCs with soft limits of load and travel too")
    command.add_argument("--plot", type=Path, metavar="FILE", help="draw the fronts as PNG")
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Simulate, print the table of fronts, and draw the figure if requested."""
    perceptions = parse_words("--perceptions", arguments.perceptions, PERCEPTIONS.names())
    wanted = front_lines(controllers_of(arguments), perceptions, arguments.limits)
    overrides = {line.condition: [*arguments.overrides, line.condition] for line in wanted if line.condition}
    found = points(driven(arguments, wanted, {"": arguments.overrides} | overrides))
    print("\n".join(front_table(found)))
    if arguments.plot:
        fronts = {
            name: (values, efficient(values), hypervolume(values)) for name, (_, values) in found.items()
        }
        files = save(fronts_figure(fronts), arguments.plot)
        console.print(f"figure: {files[0]}")
    return 0


def front_table(found: dict[str, tuple[list[str], Array]]) -> list[str]:
    """A line for each point; the first one of a controller holds the area and volume that it dominates."""
    table = ["| controller | setting | Wk RMS | tyre load | travel | dominated area | hypervolume |"]
    table.append("|---" * 7 + "|")
    for name, (conditions, values) in found.items():
        dominated = f"{hypervolume(values[:, :2]):.3f} | {hypervolume(values):.3f}"
        for condition, best, point in zip(conditions, efficient(values), values, strict=True):
            setting = condition.removeprefix("control.settings.") + ("" if best else " (dominated)")
            numbers = " | ".join(f"{value:.3f}" for value in point)
            table.append(f"| {name} | {setting} | {numbers} | {dominated} |")
            name, dominated = "", "|"
    return table
