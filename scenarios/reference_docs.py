"""Generated reference pages (Markdown): scenario fields, commands, metrics, controllers."""

import argparse
import inspect
import re
import types
from collections.abc import Iterable, Iterator
from dataclasses import MISSING, Field, fields, is_dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from foreride.comfort import METRICS
from foreride.files.plugins import Registry
from foreride.files.reading import strict
from foreride.files.reading.ranges import numbers_in
from foreride.files.writing.atomic import write_text
from foreride.scenarios.api_reference import api_page
from foreride.scenarios.cli import parser
from foreride.scenarios.column_reference import column_page
from foreride.scenarios.definition.schema import Scenario
from foreride.vehicle.energy_audit import energy_audit

_SCENARIO_HEAD = """# Scenario fields

Generated from the schema: the fields of a scenario file, also set by `--set path.to.field=value`. A
field without a default must be given, but `name` is the file's name where it is missing, and
`vehicle.parameters` holds only what differs from the car that `vehicle.model` names (`quarter`, `half`,
`full` or a YAML file).
"""
_ENTRY = re.compile(r"\s*([a-z0-9_]+(?:, [a-z0-9_]+)*): (.*)")
_NEXT_ENTRY = re.compile(r"(?<=[.;]) (?=[a-z0-9_]+(?:, [a-z0-9_]+)*: )")
_LEAVES = {float: "number", int: "whole number", str: "text", bool: "true or false", type(None): "nothing"}


def write(folder: Path) -> None:
    """Write all pages into the folder."""
    pages = {
        "scenario": scenario_page(),
        "commands": command_page(),
        "metrics": metric_page(),
        "columns": column_page(),
        "api": api_page(),
    }
    for name, text in pages.items():
        write_text(folder / f"{name}.md", text)


def scenario_page() -> str:
    """Page of all scenario fields: type, range with unit, default and description."""
    lines = [_SCENARIO_HEAD]
    for path, cls in blocks(Scenario):
        init_fields = [item for item in fields(cls) if item.init]
        prose, meanings = _described(inspect.cleandoc(cls.__doc__ or ""), {item.name for item in init_fields})
        lines += [f"## {path or 'The file itself'}", "", prose, ""]
        if init_fields:
            hints = get_type_hints(cls, include_extras=True)
            lines += ["| field | type | range | default | |", "|---|---|---|---|---|"]
            for item in init_fields:
                meaning = meanings.get(item.name) or _first_line(hints[item.name])
                allowed = ", ".join(dict.fromkeys(one.text() for one in numbers_in(hints[item.name])))
                cells = f"`{item.name}`", _type(hints[item.name]), allowed, _default(item), meaning
                lines.append(f"| {' | '.join(cells)} |")
            lines.append("")
    return "\n".join(lines)


def blocks(root: Any) -> Iterator[tuple[str, Any]]:
    """Dotted path and dataclass of every block of a document, outermost first, each class once."""
    seen, waiting = {root}, [("", root)]
    while waiting:
        path, cls = waiting.pop(0)
        yield path, cls
        hints = get_type_hints(cls, include_extras=True)
        inner = []
        for item in fields(cls):
            members = list(dict.fromkeys(_dataclasses(hints[item.name]))) if item.init else []
            place = f"{path.partition(':')[0]}.{item.name}".lstrip(".")
            for member in members:
                kind = getattr(member, "kind", None) if len(members) > 1 else None
                inner.append((f"{place}: {kind}" if kind else place, member))
        waiting = [entry for entry in inner if entry[1] not in seen] + waiting
        seen |= {member for _, member in inner}


def _described(doc: str, names: set[str]) -> tuple[str, dict[str, str]]:
    """Prose of a docstring, and its field descriptions of the form `name[, name]: text`."""
    prose: list[str] = []
    meanings: dict[str, str] = {}
    current: list[str] = []
    for line in _NEXT_ENTRY.sub("\n", doc).splitlines():
        entry = _ENTRY.match(line)
        if entry and set(entry[1].split(", ")) <= names:
            current = entry[1].split(", ")
            meanings |= dict.fromkeys(current, entry[2])
        elif current and line.strip() and line.strip() != "Args:":
            meanings |= {name: f"{meanings[name]} {line.strip()}" for name in current}
        else:
            current = []
            if line.strip() != "Args:":
                prose.append(line)
    paragraphs = "\n".join(prose).strip().split("\n\n")
    kept = [text.strip() for text in paragraphs if not text.startswith("Raises")]
    return "\n\n".join(kept), {name: text.replace("|", "\\|") for name, text in meanings.items()}


def command_page() -> str:
    """Page with the help of every command."""
    lines = ["# Commands", "", "Exit codes: 0 success, 1 a check failed, 2 bad input (in one line).", ""]
    for name, command in _commands(parser()):
        lines += [f"## {name}", "", "```text", command.format_help().rstrip(), "```", ""]
    return "\n".join(lines)


def metric_page() -> str:
    """Page of all metrics of a run with their units."""
    lines = ["# Metrics", "", "Contents of `metrics.json` of a run and of the rows of a comparison.", ""]
    lines += ["| metric | unit and meaning |", "|---|---|"]
    lines += [f"| `{name}` | {metric.definition} |" for name, metric in METRICS.parts().items()]
    lines += ["", "## Audit", "", inspect.cleandoc(energy_audit.__doc__ or ""), ""]
    return "\n".join(lines)


def _commands(top: argparse.ArgumentParser) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    for action in top._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in dict.fromkeys(action.choices.values()):
                inner = list(_commands(command))
                yield from inner or [(command.prog, command)]


def _dataclasses(hint: Any) -> Iterator[Any]:
    if is_dataclass(hint):
        yield hint
    elif (registry := _registry(hint)) is not None:
        yield from registry.parts().values()
    elif get_origin(hint) is Annotated:
        yield from _dataclasses(get_args(hint)[0])
    else:
        for argument in get_args(hint) if get_origin(hint) is not Literal else ():
            yield from _dataclasses(argument)


def _registry(hint: Any) -> Registry | None:
    """Registry of the kinds that an annotation admits, if any."""
    extras = get_args(hint)[1:] if get_origin(hint) is Annotated else ()
    return next((extra for extra in extras if isinstance(extra, Registry)), None)


def _first_line(hint: Any) -> str:
    """Summary line of the dataclass a field may hold; "" for plain values and for unions."""
    members = list(_dataclasses(hint))
    return inspect.cleandoc(members[0].__doc__ or "").partition("\n")[0] if len(members) == 1 else ""


def _type(hint: Any) -> str:
    origin, arguments = get_origin(hint), get_args(hint)
    if hint in _LEAVES:
        return _LEAVES[hint]
    if origin is Literal:
        return ", ".join(f"`{choice}`" for choice in arguments)
    if (registry := _registry(hint)) is not None:
        return _kinds(registry.parts())
    if origin is Annotated:
        return _type(arguments[0])
    if origin in (Union, types.UnionType):
        members: list[Any] = [member for member in arguments if is_dataclass(member)]
        if len(members) > 1:
            return _kinds(member.kind for member in members)
        return " or ".join(_type(member) for member in arguments)
    if origin is tuple and arguments[1:] == (Ellipsis,):
        return f"list of: {_type(arguments[0])}"
    if origin is tuple:
        return f"list of {len(arguments)}: {_type(arguments[0])}"
    if origin is dict:
        return "block of own names"
    return "a block"


def _kinds(names: Iterable[str]) -> str:
    return "a block with `kind`: " + ", ".join(f"`{name}`" for name in names)


def _default(item: Field) -> str:
    if item.default is not MISSING:
        value = item.default
    elif item.default_factory is not MISSING:
        value = item.default_factory()
    else:
        return "**required**"
    plain = strict.to_mapping(value)
    if isinstance(plain, dict):
        return f"kind `{plain['kind']}`" if "kind" in plain else "its fields' defaults"
    return "none" if plain is None else f"`{plain}`"
