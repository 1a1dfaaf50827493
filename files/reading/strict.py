"""Strict reading of YAML into frozen dataclasses: anything unknown is rejected, with its location.

Field types: `Any`, bool, int, float, str, `Literal`, `T | None`, `tuple[T, ...]`, `tuple[A, B]`,
`dict[str, T]`, dataclasses, and unions of dataclasses discriminated by the key `kind`, which each member
carries as `kind: ClassVar[str]`. `Annotated[Base, registry]` is such a union, open to the registry's further
members.
"""

import sys
import types
import typing
from collections.abc import Callable, Iterable
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from foreride.files.errors import InputError, nearest, printable, shortened, shown
from foreride.files.plugins import Registry
from foreride.files.reading.regular_file import read_text, reading
from foreride.files.reading.yaml12 import is_plain, parse

_LEAVES = {float: "a number", int: "a whole number", str: "text", bool: "true or false"}


def read(cls: Any, path: Path | str) -> Any:
    """Read the YAML file at `path` into `cls` (a dataclass, or a union of dataclasses).

    Raises InputError, in one line, for a file that cannot be read, is not YAML or does not describe a `cls`.
    """
    return structure(cls, parse(read_text(path), str(path)), str(path))


def structure(cls: Any, mapping: Any, source: str) -> Any:
    """Convert a plain mapping to `cls`; `source` names the origin of the mapping.

    Raises InputError naming source, dotted path, offending value and what is allowed.
    """
    with reading(source):
        try:
            return _build(cls, mapping, "")
        except InputError as error:
            raise InputError(printable(f"{source}: {error}")) from None


def to_mapping(obj: Any) -> Any:
    """Convert to plain dicts, lists and scalars, from which `structure` restores an equal object."""
    if is_dataclass(obj) and not isinstance(obj, type):
        kind = _tag(type(obj))
        tag = {"kind": kind} if kind else {}
        return tag | {f.name: to_mapping(getattr(obj, f.name)) for f in fields(obj) if f.init}
    if isinstance(obj, list | tuple):
        return [to_mapping(item) for item in obj]
    if isinstance(obj, dict):
        return {key: to_mapping(value) for key, value in obj.items()}
    return obj


def _build(cls: Any, value: Any, path: str) -> Any:
    """Dispatch on the requested type; `path` is the dotted location of `value` in the document."""
    origin, args = get_origin(cls), get_args(cls)
    if origin is Annotated:
        registry = next((item for item in args[1:] if isinstance(item, Registry)), None)
        return _registered(registry, value, path) if registry else _build(args[0], value, path)
    if origin in (Union, types.UnionType):
        return _union(args, value, path)
    if cls is Any:
        return value
    if cls in _LEAVES:
        return _leaf(cls, value, path)
    if origin is Literal:
        return _literal(args, value, path)
    if origin is tuple:
        return _tuple(args, value, path)
    if origin is dict:
        return _dict(args[1], value, path)
    if is_dataclass(cls):
        return _dataclass(cls, value, path)
    raise TypeError(f"{path or 'the document'}: no rule to read a {cls!r} from YAML")


def _leaf(cls: type, value: Any, path: str) -> Any:
    valid = type(value) is cls or (cls is float and type(value) is int)
    if not valid:
        raise _refusal(path, f"must be {_LEAVES[cls]}, got {shown(value)}")
    if cls is float and not abs(value) <= sys.float_info.max:  # the comparison also holds for huge integers
        raise _refusal(path, f"must be a finite number, got {shown(value)}")
    if cls is str and not is_plain(value):
        raise _refusal(path, f"must hold no control characters, got {shown(value)}")
    return cls(value)


def _literal(allowed: tuple, value: Any, path: str) -> Any:
    # 1 == True in Python, so the type is compared as well.
    if not any(value == item and type(value) is type(item) for item in allowed):
        suggestion = nearest(value, allowed)
        raise _refusal(path, f"must be one of {_listed(allowed)}, got {shown(value)}{suggestion}")
    return value


def _tuple(args: tuple, value: Any, path: str) -> tuple:
    if not isinstance(value, list | tuple):
        raise _refusal(path, f"must be a list, got {shown(value)}")
    if len(args) == 2 and args[1] is Ellipsis:
        args = args[:1] * len(value)
    if len(value) != len(args):
        raise _refusal(path, f"must be a list of {len(args)} values, got {len(value)}")
    return tuple(_build(args[i], item, f"{path}[{i}]") for i, item in enumerate(value))


def _dict(cls: Any, value: Any, path: str) -> dict[str, Any]:
    _require_mapping(value, path)
    return {key: _build(cls, item, _join(path, key)) for key, item in value.items()}


def _union(members: tuple, value: Any, path: str) -> Any:
    if value is None and type(None) in members:
        return None
    concrete = tuple(member for member in members if member is not type(None))
    lists = [member for member in concrete if get_origin(member) is tuple]
    if len(lists) == 1 and isinstance(value, list | tuple):
        return _build(lists[0], value, path)
    concrete = tuple(member for member in concrete if member not in lists) or concrete
    if len(concrete) == 1:
        return _build(concrete[0], value, path)
    kinds = {_tag(member): member for member in concrete}
    return _by_kind(list(kinds), kinds.get, value, path)


def _registered(registry: Registry, value: Any, path: str) -> Any:
    return _by_kind(registry.names(), registry.find, value, path)


def _by_kind(kinds: list, find: Callable[[str], Any], value: Any, path: str) -> Any:
    _require_mapping(value, path)
    if "kind" not in value:
        raise _refusal(_join(path, "kind"), f"is missing; it must be one of {_listed(kinds)}")
    kind = value["kind"]
    if not isinstance(kind, str) or kind not in kinds:
        allowed = f"must be one of {_listed(kinds)}, got {shown(kind)}{nearest(kind, kinds)}"
        raise _refusal(_join(path, "kind"), allowed)
    try:
        cls = find(kind)
    except InputError as error:
        raise _refusal(_join(path, "kind"), str(error)) from None
    return _dataclass(cls, value, path)


def _dataclass(cls: Any, value: Any, path: str) -> Any:
    _require_mapping(value, path)
    hints = _hints(cls)
    remaining = dict(value)
    if (tag := _tag(cls)) and remaining.pop("kind", tag) != tag:
        raise _refusal(_join(path, "kind"), f"must be {tag}, got {shown(value['kind'])}")
    for key in remaining:
        if key not in hints:
            suggestion = nearest(key, hints) or f"; allowed are {_listed(hints)}"
            raise _refusal(_join(path, shortened(key)), f"is not a known key{suggestion}")
    for field in fields(cls):
        if field.name in hints and field.name not in remaining and not _has_default(field):
            raise _refusal(_join(path, field.name), "is missing")
    arguments = {key: _build(hints[key], item, _join(path, key)) for key, item in remaining.items()}
    try:
        return cls(**arguments)
    except InputError as error:
        raise InputError(_join(path, str(error))) from None


@cache
def _hints(cls: Any) -> dict[str, Any]:
    hints = typing.get_type_hints(cls, include_extras=True)
    return {f.name: hints[f.name] for f in fields(cls) if f.init}


def _tag(cls: Any) -> str | None:
    """Discriminator `kind` of a union's member; None for an untagged class."""
    tag = getattr(cls, "kind", None)
    return tag if isinstance(tag, str) and "kind" not in {f.name for f in fields(cls)} else None


def _has_default(field: Any) -> bool:
    return field.default is not MISSING or field.default_factory is not MISSING


def _require_mapping(value: Any, path: str) -> None:
    if not isinstance(value, dict) or not all(isinstance(key, str) for key in value):
        raise _refusal(path, f"must be a mapping of named values, got {shown(value)}")


def _join(path: str, key: str) -> str:
    return f"{path}.{key}" if path else key


def _refusal(path: str, message: str) -> InputError:
    return InputError(f"{path or 'the document'} {message}")


def _listed(names: Iterable[Any]) -> str:
    return ", ".join(str(name) for name in names)
