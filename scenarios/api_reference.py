"""Generated reference page (Markdown) of the public Python interface, from its signatures and docstrings."""

import importlib
import inspect
import re
from collections.abc import Iterator
from typing import Any

_HEAD = """# Public interface

Generated from the docstrings of the names in `__all__` of foreride; [As a library](../library.md) shows them
in use.
"""
_QUALIFIED = re.compile(r"\b(?:foreride|collections|typing|numpy|pathlib)(?:\.[a-z_]\w*)*\.(?=[A-Z_a-z])")
_SHAPED = re.compile(r"ndarray\[tuple\[Any, \.\.\.\], dtype\[\w+\]\]")


def api_page() -> str:
    """Page of all public names: signature, docstring and, for classes, public methods and properties."""
    interface = importlib.import_module("foreride")
    parts = [_HEAD]
    for name in interface.__all__:
        parts.append(_entry(name, getattr(interface, name)))
    return "\n".join(parts)


def _entry(name: str, item: Any) -> str:
    lines = [f"## {name}", "", "```text", f"{name}{_signature(item)}", "```", "", _doc(item), ""]
    if inspect.isclass(item) and not issubclass(item, Exception):
        for member, value in _members(item):
            lines += [f"* `{member}{_signature(value)}`: {_doc(value).partition(chr(10) * 2)[0]}"]
        lines.append("")
    return "\n".join(lines)


def _members(cls: type) -> Iterator[tuple[str, Any]]:
    """Public methods and properties that a class defines itself, with docstrings."""
    for name, value in vars(cls).items():
        inner = getattr(value, "func", getattr(value, "fget", value))  # of a cached property, a property
        if not name.startswith("_") and inspect.isfunction(inner) and inner.__doc__:
            yield name, value


def _signature(item: Any) -> str:
    if not callable(item) or (inspect.isclass(item) and issubclass(item, Exception)):
        return ""
    try:
        text = str(inspect.signature(item))
    except (TypeError, ValueError):
        return ""
    for long, short in (("(self, ", "("), ("(self)", "()"), ("'", ""), ("pyarrow.lib.", "pyarrow.")):
        text = text.replace(long, short)
    return _SHAPED.sub("ndarray", _QUALIFIED.sub("", text))


def _doc(item: Any) -> str:
    """Docstring with its `Args` as a list."""
    text = inspect.getdoc(item) or ""
    lines = [line for line in text.splitlines() if line.strip() != "Args:"]
    return "\n".join(re.sub(r"^ {4,}(\w[\w, ]*): ", r"* `\1`: ", line) for line in lines)
