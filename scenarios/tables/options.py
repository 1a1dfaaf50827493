"""Options of the table commands: events, vehicle, seeds, files of rows, and comma-separated lists."""

from argparse import Namespace
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from foreride.files.command_line import Parser, output_path
from foreride.files.errors import InputError, shown
from foreride.files.reading.numbers import parse_whole_numbers
from foreride.files.reading.ranges import MAX_SEED
from foreride.scenarios.definition.overrides import Override, collect_overrides, parse_override


def table_parser(name: str, description: str) -> Parser:
    """Parser of one table's options."""
    return Parser(prog=f"foreride table {name}", description=description)


def shared_parser(name: str, description: str, seeds: str) -> Parser:
    """Parser with the options of all tables over a set of events."""
    parser = table_parser(name, description)
    parser.add_argument(
        "--events", nargs="+", default=["reporting"], help="scenarios or sets (default reporting)"
    )
    parser.add_argument("--vehicle", default="half", help="quarter, half or full (default half)")
    parser.add_argument("--seeds", default=seeds, help=f"default {seeds}")
    parser.add_argument("--set", action="append", default=[], dest="overrides", metavar="PATH.TO.FIELD=VALUE")
    parser.add_argument("--json", type=output_path, metavar="FILE", help="write all rows")
    told = "reuse rows of --json files of parts of this table, and simulate only missing ones"
    parser.add_argument("--read", nargs="+", type=Path, default=[], metavar="FILE", help=told)
    return parser


def parse_words(option: str, text: str, allowed: Sequence[str], separator: str = ",") -> list[str]:
    """Split a comma-separated option. Raises InputError for an entry that is not allowed."""
    words = text.split(separator)
    for word in words:
        if word not in allowed:
            raise InputError(f"{option}: must be of {', '.join(allowed)}, got {shown(word)}")
    return words


def whole_numbers(option: str, text: str) -> list[int]:
    """Split a comma-separated option into integers >= 0. Raises InputError."""
    return parse_whole_numbers(f"{option}:", text.split(","), MAX_SEED)


def selected_overrides(selected: Namespace, fields: Mapping[str, Any] | None = None) -> list[Override]:
    """Overrides of `--vehicle` and `--set`, then those of a line of the table."""
    vehicle = Override(("vehicle", "model"), selected.vehicle, "--vehicle")
    return [vehicle, *map(parse_override, selected.overrides), *collect_overrides(fields or {})]
