"""YAML 1.2 parser with core-schema scalars, no duplicate keys and one-line errors.

PyYAML reads YAML 1.1, where `1e7` is text, `no` is false and `12:30` is 750; the core schema of YAML 1.2.2
(section 10.3.2) has none of these surprises. Aliases count as often as they are expanded: a text that expands
to more than `MAX_NODES` values, or deeper than `MAX_DEPTH`, is rejected before it is built.
"""

import re
import unicodedata
from functools import lru_cache
from typing import Any

import yaml

from foreride.files.errors import InputError, printable, shortened, shown
from foreride.files.reading.regular_file import reading

MAX_NODES = 200_000
MAX_DEPTH = 50
_MESSAGE_LENGTH = 200
_CORE_SCHEMA = {
    "bool": (r"true|True|TRUE|false|False|FALSE", "tTfF"),
    "int": (r"[-+]?(?:0|[1-9][0-9]*)", "-+0123456789"),
    "float": (
        r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)",
        "-+.0123456789",
    ),
    "null": (r"~|null|Null|NULL|", ["~", "n", "N", ""]),
}
_TAG = "tag:yaml.org,2002:"
_SPELLINGS = {f"{_TAG}{name}": re.compile(pattern) for name, (pattern, _) in _CORE_SCHEMA.items()}
_KINDS = {f"{_TAG}seq": yaml.SequenceNode, f"{_TAG}map": yaml.MappingNode, f"{_TAG}str": yaml.ScalarNode}
_KINDS |= dict.fromkeys(_SPELLINGS, yaml.ScalarNode)


class _Loader(yaml.SafeLoader):
    """PyYAML's safe loader with the implicit scalars of the core schema."""

    yaml_implicit_resolvers: dict = {}  # noqa: RUF012  (PyYAML's own name)
    nodes = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        self.nodes += 1
        if self.nodes > MAX_NODES:
            raise yaml.MarkedYAMLError(problem=f"more than {MAX_NODES} values", problem_mark=self.get_mark())
        return super().compose_node(parent, index)  # type: ignore[no-untyped-call]

    def get_single_node(self) -> Any:
        node = super().get_single_node()
        if node is not None:
            _check(node, {})
        return node


for _name, (_pattern, _first) in _CORE_SCHEMA.items():
    _Loader.add_implicit_resolver(f"{_TAG}{_name}", re.compile(rf"^(?:{_pattern})$"), list(_first))


def parse(text: str, source: str) -> Any:
    """Parse YAML text to a plain value; InputError names `source` and the line of a fault."""
    with reading(source):
        try:
            return _copied(_parsed(text))
        except yaml.MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            line = f", line {mark.line + 1}" if mark else ""
            raise InputError(
                f"{printable(source)}{line}: {_one_line(error.problem or 'not valid YAML')}"
            ) from None
        except yaml.YAMLError as error:
            raise InputError(f"{printable(source)}: {_one_line(error)}") from None


def is_plain(text: str) -> bool:
    """Whether the text is free of lone surrogates and of control characters except tab and line end."""
    return not any(c not in "\t\n" and unicodedata.category(c) in ("Cc", "Cs") for c in text)


@lru_cache(maxsize=256)
def _parsed(text: str) -> Any:
    """Parse with caching, as a sweep reads the same few files for each of its drives."""
    return yaml.load(text, Loader=_Loader)


def _copied(value: Any) -> Any:
    """Deep copy of the value's containers, also of aliased ones."""
    if isinstance(value, dict):
        return {key: _copied(child) for key, child in value.items()}
    return [_copied(child) for child in value] if isinstance(value, list) else value


def _check(node: yaml.Node, known: dict[yaml.Node, tuple[int, int] | None]) -> tuple[int, int]:
    """Number of values and levels to which the node expands; MarkedYAMLError for anything rejected in it."""
    if node in known:
        if (known_size := known[node]) is None:
            raise _mistake(node, "an alias must not refer to a node that contains it")
        return known_size
    known[node] = None
    _check_tag(node)
    if isinstance(node, yaml.MappingNode):
        _check_keys(node)
        children = [_check(value, known) for _, value in node.value]
    else:
        children = [_check(value, known) for value in node.value] if isinstance(node.value, list) else []
    count = 1 + sum(size for size, _ in children)
    depth = 1 + max((levels for _, levels in children), default=0)
    if count > MAX_NODES:
        raise _mistake(node, f"its aliases expand to more than {MAX_NODES} values")
    if depth > MAX_DEPTH:
        raise _mistake(node, f"is nested more than {MAX_DEPTH} levels deep")
    known[node] = count, depth
    return count, depth


def _check_tag(node: yaml.Node) -> None:
    kind, spelling = _KINDS.get(node.tag), _SPELLINGS.get(node.tag)
    tag = shown(node.tag.replace(_TAG, "!!"))
    if kind is None:
        raise _mistake(node, f"the tag {tag} is not known")
    if not isinstance(node, kind) or (spelling and not spelling.fullmatch(node.value)):
        raise _mistake(node, f"the tag {tag} does not match its value")
    if isinstance(node, yaml.ScalarNode) and not is_plain(node.value):
        raise _mistake(node, f"text must hold no control characters, got {shown(node.value)}")


def _check_keys(node: yaml.MappingNode) -> None:
    keys: set[str] = set()
    for key, _ in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise _mistake(key, "a key must be plain text")
        _check_tag(key)
        if key.value in keys:
            raise _mistake(key, f"the key {shown(key.value)} appears twice")
        keys.add(key.value)


def _mistake(node: yaml.Node, problem: str) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark)


def _one_line(problem: object) -> str:
    return shortened(printable(problem), _MESSAGE_LENGTH)
