"""Tests that every command named in documentation, examples and docstrings is accepted by its own parser.

Commands stand in `sh` and `bash` blocks, in code spans and in `run:` lines of workflows. A code span may
leave out required arguments or a last value (`foreride table budget --json`); its options exist all the same.
"""

import argparse
import ast
import importlib.util
import re
import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

import pytest

from foreride.scenarios import cli

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = (
    "benchmarks", "comfort", "controller", "detector", "docs", "examples", "files", "foreride", "preview",
    "road", "scenarios", "tests", "vehicle",
)  # fmt: skip
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
SPAN = re.compile(r"`([^`]+)`")
STARTS = ("foreride", ".venv/bin/foreride", "python", "make")
PARTIAL = re.compile(r"the following arguments are required|expected (one|at least one) argument")


class Accepted(BaseException):
    """Raised by a parser that has accepted its arguments, in place of what the command would do."""


class Refused(BaseException):
    """Raised by a parser that has refused its arguments."""

    def __init__(self, parser: argparse.ArgumentParser, message: str):
        super().__init__(message)
        self.options = set(parser._option_string_actions)


def texts() -> Iterator[tuple[str, str]]:
    """Path and text of every file that may name a command; of Python files the string literals."""
    pages = [*ROOT.glob("*.md"), *(page for folder in FOLDERS for page in (ROOT / folder).rglob("*.md"))]
    files = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*.y*ml")]
    for page in pages:
        if page.name != "CHANGELOG.md" and "reference" not in page.parts:
            yield str(page.relative_to(ROOT)), page.read_text(encoding="utf-8")
    for path in files:
        lines = path.read_text(encoding="utf-8").splitlines()
        comments = " ".join(line.lstrip("# ") for line in lines if line.startswith("#"))
        runs = " ".join(f"`{line.partition('run:')[2].strip()}`" for line in lines if "run:" in line)
        yield str(path.relative_to(ROOT)), f"{comments} {runs}"
    for path in (path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        literals = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
        yield str(path.relative_to(ROOT)), "\n\n".join(text for text in literals if isinstance(text, str))


def commands(text: str) -> Iterator[tuple[list[str], bool]]:
    """Words of each command of a text, and whether it may be partial."""
    for kind, block in BLOCK.findall(text):
        for line in block.replace("\\\n", " ").splitlines() if kind in ("sh", "bash") else ():
            if line.startswith(STARTS):
                yield shlex.split(line, comments=True), False
    for span in SPAN.findall(BLOCK.sub("", text)):
        words = span.replace("[", " ").replace("]", " ").split()
        if words and words[0] in STARTS:
            yield shlex.split(span) if "[" not in span or "{" in span else words, True


def alternatives(words: list[str]) -> list[str]:
    """The words with the first of each `a|b|c`, without ellipses."""
    first = [word.partition("|")[0] if not word.startswith("{") else word for word in words]
    return [word.removesuffix("...") for word in first if word != "..."]


def named() -> dict[tuple[str, ...], list[tuple[str, bool]]]:
    """Places of every command, and whether it may be partial there."""
    places: dict[tuple[str, ...], list[tuple[str, bool]]] = {}
    for place, text in texts():
        for words, partial in commands(text):
            if len(words) > 1:
                places.setdefault(tuple(alternatives(words)), []).append((place, partial))
    return places


COMMANDS = named()


def module_of(words: tuple[str, ...]) -> tuple[ModuleType | None, list[str]]:
    """The module that `python` would run, if it has a parser, and its arguments."""
    name = words[2] if words[1] == "-m" else words[1].removesuffix(".py").replace("/", ".")
    rest = list(words[3:] if words[1] == "-m" else words[2:])
    spec = importlib.util.find_spec(name)
    if spec is not None and spec.submodule_search_locations:
        spec = importlib.util.find_spec(f"{name}.__main__")
    assert spec is not None, name
    assert spec.origin is not None, name
    if "parse_args" not in Path(spec.origin).read_text():
        assert not rest, f"{name} takes no arguments"
        return None, []
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)  # type: ignore[union-attr]
    return module, rest


@pytest.fixture
def parsers_only(monkeypatch: pytest.MonkeyPatch) -> None:
    def accepting(parse: Callable[..., argparse.Namespace]) -> Callable[..., argparse.Namespace]:
        def parse_args(parser: argparse.ArgumentParser, *arguments: Any) -> argparse.Namespace:
            accepted = parse(parser, *arguments)
            if not hasattr(accepted, "rest"):  # of a command whose module has a parser of its own
                raise Accepted
            return accepted

        return parse_args

    def error(parser: argparse.ArgumentParser, message: str) -> NoReturn:
        raise Refused(parser, message)

    for kind in (argparse.ArgumentParser, cli.Parser):
        monkeypatch.setattr(kind, "parse_args", accepting(kind.parse_args))
        monkeypatch.setattr(kind, "error", error)


def parse(words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """Give a command to its parser. Raises Accepted or Refused, unless it has none."""
    if words[0] == "make":
        assert re.search(rf"^{words[1]}:", (ROOT / "Makefile").read_text(), re.MULTILINE)
    elif words[0] != "python":
        cli.main(words[1:])
    else:
        module, rest = module_of(words)
        if module is not None:
            monkeypatch.setattr(sys, "argv", [words[1], *rest])
            module.main()


def refusal_of(words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> Refused | None:
    try:
        parse(words, monkeypatch)
    except Accepted:
        return None
    except Refused as refusal:
        return refusal
    except SystemExit as end:
        if end.code:  # 0 after --help
            raise
    return None


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_a_command_is_accepted_by_its_parser(
    words: tuple[str, ...], parsers_only: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    if (refusal := refusal_of(words, monkeypatch)) is not None:
        assert all(partial for _, partial in COMMANDS[words]), (refusal, COMMANDS[words])
        assert PARTIAL.search(str(refusal)), (refusal, COMMANDS[words])
        options = {word.partition("=")[0] for word in words if word.startswith("--")}
        assert options <= refusal.options, COMMANDS[words]


def test_commands_are_found_everywhere() -> None:
    places = {place for found in COMMANDS.values() for place, _ in found}
    assert {
        "README.md",
        "docs/quickstart.md",
        "detector/weights/README.md",
        "examples/own_map.yaml",
    } <= places
    assert {"scenarios/tables/budget.py", "examples/regression/github_actions.yml"} <= places
    assert len(COMMANDS) > 100
