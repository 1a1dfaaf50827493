"""Controllers on random roads: means relative to the passive car, and what of perfect preview's gain is kept.

`foreride table random_roads --first 1000 --events 100 --jobs 2 --json rows.jsonl`. Each event is drawn from
its number alone (`scenarios.random_roads.events`); settings may be chosen on numbers below 1000, nothing from
there on. All values are relative to the passive car on the same event and seed, with 95 % intervals of a
bootstrap over events and seeds. Kept is the share of the gain of `mpc_preview@oracle` over a rival that
`mpc_preview` keeps with another perception; with the perception `obstacles`, also the share of the gain that
exact obstacles alone give. The file of rows grows drive by drive, and a second call goes on where the first
ended, with other controllers too.
"""

import json
from argparse import ArgumentParser, Namespace
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from foreride.controller.registry import CONTROLLERS
from foreride.controller.tuned_settings import TUNED_CONTROLLERS
from foreride.files.errors import InputError
from foreride.files.writing.targets import check_files
from foreride.scenarios.commands.console import tracked
from foreride.scenarios.comparison import row_file
from foreride.scenarios.definition.overrides import parse_override
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.random_roads.drives import Drive, Line, Row, lines, missing, simulated
from foreride.scenarios.random_roads.events import REPORTING, event_fields, kind_of
from foreride.scenarios.random_roads.results import Results, collected, interval, mean, share_kept, worse
from foreride.scenarios.tables.options import parse_words, table_parser, whole_numbers
from foreride.scenarios.tables.runs import shown

RIVALS = ("mpc_reactive", "mpc_wheelbase")
ORACLE, OBSTACLES = Line("mpc_preview", "oracle"), Line("mpc_preview", "obstacles")
NEEDED = {"event", "seed", "condition", "controller", "perception", "scenario_hash", "metrics"}
_SHOWN = {"objective": "J", "wk_rms": "Wk RMS", "tyre_load_rms": "tyre load", "rattle_rms": "travel"}


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print the tables, and keep the rows if requested. Raises InputError."""
    parser = table_parser("random_roads", "controllers on random roads that nothing was tuned on")
    add_random_options(parser, events=100, seeds="0")
    parser.add_argument("--perceptions", default="oracle,boxes", help="of mpc_preview (default oracle,boxes)")
    parser.add_argument("--write-events", type=Path, metavar="FOLDER", help="only write the scenario files")
    asked = parser.parse_args(arguments)
    events = events_of(asked)
    if asked.write_events:
        return _write_events(asked.write_events, events)
    perceptions = parse_words("--perceptions", asked.perceptions, PERCEPTIONS.names())
    wanted = lines(controllers_of(asked), perceptions)
    results = driven(asked, wanted, {"": asked.overrides})
    print("\n".join([*line_table(results), "", *kept_table(results), "", *kind_table(results)]))


def add_random_options(
    parser: ArgumentParser, events: int, seeds: str, controllers: str = ",".join([*RIVALS, "mpc_preview"])
) -> None:
    """Add the options of commands over random events."""
    parser.add_argument(
        "--first", type=int, default=REPORTING, help=f"number of the first event (default {REPORTING})"
    )
    parser.add_argument("--events", type=int, default=events, help=f"how many (default {events})")
    parser.add_argument("--seeds", default=seeds, help=f"of sensors and boxes (default {seeds})")
    parser.add_argument("--controllers", default=controllers, help=f"beside passive (default {controllers})")
    parser.add_argument("--set", action="append", default=[], dest="overrides", metavar="PATH.TO.FIELD=VALUE")
    parser.add_argument("--jobs", type=int, default=1, help="processes (default 1)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="keep one row a line, and go on from there")


def controllers_of(asked: Namespace) -> list[str]:
    """Controllers asked for, passive first. Raises InputError for an unknown one."""
    names = parse_words("--controllers", asked.controllers, CONTROLLERS.names())
    return list(dict.fromkeys(["passive", *names]))


def events_of(asked: Namespace) -> range:
    """Numbers of the events asked for. Raises InputError."""
    if asked.events < 1 or asked.first < 0 or asked.jobs < 1:
        raise InputError("--events and --jobs must be >= 1, --first >= 0")
    return range(asked.first, asked.first + asked.events)


def driven(asked: Namespace, wanted: Sequence[Line], overrides: Mapping[str, Sequence[str]]) -> Results:
    """Results of all lines, with the overrides of their conditions; missing drives are simulated."""
    check_files(asked.json)
    events, seeds = events_of(asked), whole_numbers("--seeds", asked.seeds)
    parsed = {name: [parse_override(text) for text in texts] for name, texts in overrides.items()}
    drives = [Drive(event, seed, line) for event in events for seed in seeds for line in wanted]
    rows: list[Row] = list(row_file.resume(asked.json, NEEDED))
    due = missing(drives, rows, parsed)
    new = tracked(simulated(due, parsed, asked.jobs), "drives", len(due))
    rows += row_file.kept(asked.json, new)
    return collected(rows, wanted, events, seeds)


def _write_events(folder: Path, events: Sequence[int]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for number in events:
        (folder / f"random_{number}.yaml").write_text(json.dumps(event_fields(number), indent=1) + "\n")
    print(f"{len(events)} scenarios: {folder}")


def line_table(results: Results) -> list[str]:
    """Mean of each line relative to passive."""
    heads = [f"{name} / passive" for name in _SHOWN.values()]
    table = [f"| controller | {' | '.join(heads)} | worse than passive |", "|---|---|---|---|---|---|"]
    for line in results.of_line:
        cells = [shown(interval(mean, results.relative(line, metric))) for metric in _SHOWN]
        relative = results.relative(line)
        cells.append(f"{worse(relative, np.ones_like(relative))} of {len(results.events)}")
        table.append(f"| {line.name} | {' | '.join(cells)} |")
    return table + _best_law(results)


def _best_law(results: Results) -> list[str]:
    """Line of the law that is best in hindsight, event by event, if several ran."""
    laws = [results.relative(line) for line in results.of_line if line.controller in TUNED_CONTROLLERS]
    if len(laws) < 2:
        return []
    best = shown(interval(mean, np.min(laws, axis=0)))
    return [f"| best of {len(laws)} laws, event by event | {best} | | | | |"]


def kept_table(results: Results) -> list[str]:
    """What `mpc_preview` keeps of the oracle's gain, and events in which it is worse, for each perception."""
    rivals = [line for name in RIVALS if (line := Line(name, "none")) in results.of_line]
    if not rivals:
        return []
    limits = [(ORACLE, "gain")] + [(OBSTACLES, "of exact obstacles")] * (OBSTACLES in results.of_line)
    heads = [
        " | ".join([*(f"{head} kept over {rival.name}" for _, head in limits), "worse by > 1 %"])
        for rival in rivals
    ]
    columns = len(rivals) * (len(limits) + 1) + 2
    table = [f"| preview | {' | '.join(heads)} | worst event |", "|---" * columns + "|"]
    for line in (line for line in results.of_line if line.controller == "mpc_preview"):
        cells = [cell for rival in rivals for cell in _against(results, line, rival, dict(limits))]
        table.append(f"| {line.name} | {' | '.join(cells)} | {_worst(results, line, rivals)} |")
    return table


def _against(results: Results, line: Line, rival: Line, limits: Iterable[Line]) -> list[str]:
    """Share of each limit's gain over the rival that the line keeps, and how often it is worse."""
    of_rival, of_line = results.relative(rival), results.relative(line)
    kept = [
        shown(interval(share_kept, of_rival, of_line, results.relative(limit)), ".0%")
        if limit in results.of_line
        else "-"
        for limit in limits
    ]
    return [*kept, f"{worse(of_line, of_rival)} of {len(results.events)}"]


def _worst(results: Results, line: Line, rivals: Sequence[Line]) -> str:
    """The event with the largest J relative to the better of the rivals."""
    best = np.min([results.relative(rival).mean(axis=1) for rival in rivals], axis=0)
    ratio = results.relative(line).mean(axis=1) / best
    index = int(np.argmax(ratio))
    return f"{ratio[index] - 1.0:+.1%} in {results.events[index]} ({kind_of(results.events[index])})"


def kind_table(results: Results) -> list[str]:
    """Mean J relative to passive by kind of event."""
    kinds = np.array([kind_of(event) for event in results.events])
    table = [f"| event | events | {' | '.join(line.name for line in results.of_line)} |"]
    table.append("|---" * (len(results.of_line) + 2) + "|")
    for kind in dict.fromkeys(kinds.tolist()):
        means = [f"{results.relative(line)[kinds == kind].mean():.3f}" for line in results.of_line]
        table.append(f"| {kind} | {int(np.sum(kinds == kind))} | {' | '.join(means)} |")
    return table
