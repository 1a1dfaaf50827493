"""Registry of named parts: foreride's own, those of installed packages (entry points) and registered ones.

An entry point's name is the part's name. It is loaded when that name is used, so that a package that fails to
load stops only what needs it. Entry points are seen by every process, worker processes included; a part
registered by a call is known only to the processes that make the call.
"""

from collections.abc import Callable, Mapping
from functools import cache
from importlib.metadata import EntryPoint, EntryPoints, entry_points
from pathlib import Path
from typing import Any, Generic, TypeVar

from foreride.files.errors import InputError, printable, shown
from foreride.files.own_code import error_text, say_once, waiting_for

Part = TypeVar("Part")


@cache
def _installed() -> EntryPoints:
    """Entry points of all installed packages, read once."""
    return entry_points()


@cache
def _of_group(group: str) -> tuple[EntryPoint, ...]:
    """Those of a group."""
    return tuple(_installed().select(group=group))


class Registry(Generic[Part]):
    """Parts of one sort by name.

    group: the entry points' group. noun: the part's sort, for messages. own: foreride's parts, whose names
    are taken. accept(name, value): the part that a package's or user's value stands for; raises InputError,
    without the name, for a value that is none.
    """

    def __init__(
        self, group: str, noun: str, own: Mapping[str, Part], accept: Callable[[str, Any], Part]
    ) -> None:
        self.group, self.noun, self.own = group, noun, dict(own)
        self._accept = accept
        self._registered: dict[str, Part] = {}
        self._loaded: dict[str, Part | InputError] = {}

    def register(self, name: str, value: Any, replace: bool = False) -> None:
        """Add a part; `replace` permits to register a name again, as in a notebook.

        Raises InputError for a taken name and for a value of the wrong type.
        """
        label = f"{self.noun} {shown(name)}"
        if not (isinstance(name, str) and name.isidentifier()):
            raise InputError(f"{label}: the name must be a Python identifier")
        holders = self._holders(name) + (["this process"] if name in self._registered and not replace else [])
        if holders:
            raise InputError(f"{label}: the name is taken by {' and '.join(holders)}")
        self._registered[name] = self._accepted(label, name, value)

    def unregister(self, name: str) -> None:
        """Remove a part added by `register`."""
        self._registered.pop(name, None)

    def names(self) -> list[str]:
        """Names of all parts: foreride's own first, then the others in alphabetical order."""
        others = {*self._registered, *(entry.name for entry in _of_group(self.group))}
        return [*self.own, *sorted(others - set(self.own))]

    def find(self, name: str) -> Part | None:
        """Return the part of that name; None if there is none.

        foreride's own parts are never replaced. Raises InputError if the package does not load, or if two
        packages give the same name.
        """
        entries = self._entries(name)
        if name in self.own:
            for entry in entries:
                say_once(f"{self.group} {name}", f"{self.noun} {name}: is foreride's own; {_left_out(entry)}")
            return self.own[name]
        if name in self._registered:
            return self._registered[name]
        if not entries:
            return None
        if name not in self._loaded:
            self._loaded[name] = self._load(name, entries)
        part = self._loaded[name]
        if isinstance(part, InputError):
            raise InputError(part)
        return part

    def parts(self) -> dict[str, Part]:
        """All parts by name; a part that does not load is left out with a warning, once."""
        found: dict[str, Part] = {}
        for name in self.names():
            try:
                part = self.find(name)
            except InputError as error:
                say_once(str(error), f"{error}; it is left out")
                continue
            assert part is not None
            found[name] = part
        return found

    def _load(self, name: str, entries: list[EntryPoint]) -> Part | InputError:
        label = f"{self.noun} {printable(name)}"
        if len(entries) > 1:
            return InputError(f"{label}: is given by {' and '.join(map(_package, entries))}; uninstall one")
        label += f" of {_package(entries[0])}"
        try:
            with waiting_for(f"{label} to load"):
                value = entries[0].load()
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # a package may raise anything, SystemExit too
            return InputError(f"{label}: does not load ({error_text(error, Path(entries[0].module))})")
        try:
            return self._accepted(label, name, value)
        except InputError as error:
            return error

    def _accepted(self, label: str, name: str, value: Any) -> Part:
        try:
            return self._accept(name, value)
        except InputError as error:
            raise InputError(f"{label}: {error}") from None

    def _entries(self, name: str) -> list[EntryPoint]:
        return [entry for entry in _of_group(self.group) if entry.name == name]

    def _holders(self, name: str) -> list[str]:
        own = ["foreride"] if name in self.own else []
        return own + [_package(entry) for entry in self._entries(name)]


def tagged_class(base: type) -> Callable[[str, Any], Any]:
    """`accept` of a registry of dataclasses that derive from `base` and carry their name as `kind`."""

    def accept(name: str, value: Any) -> Any:
        if not (
            isinstance(value, type) and issubclass(value, base) and "__dataclass_fields__" in vars(value)
        ):
            raise InputError(f"must be a dataclass derived from {base.__name__}, got {shown(value)}")
        if (kind := getattr(value, "kind", None)) != name:
            raise InputError(f"must carry its name as kind, got kind {shown(kind)}")
        return value

    return accept


def _package(entry: EntryPoint) -> str:
    """Name and version of the package that an entry point belongs to."""
    return printable(f"{entry.dist.name} {entry.dist.version}" if entry.dist else entry.value)


def _left_out(entry: EntryPoint) -> str:
    return f"that of {_package(entry)} is left out"
