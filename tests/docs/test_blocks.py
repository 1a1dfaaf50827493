"""Tests that every code block of the documentation runs.

On one page, in order, in one empty folder: `yaml` and `python` blocks whose first line is `# name.ext` become
that file; `python` blocks run one after another in one namespace; lines of `bash` blocks run. Lines of `sh`
blocks take long or need special hardware; test_commands.py gives them to their parsers.
"""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from foreride.controller.fmu_controller import FmuControllerMap
from foreride.files.own_code import FMUS_ALLOWED
from foreride.files.reading import strict
from foreride.scenarios.cli import main
from foreride.scenarios.definition.loading import load
from foreride.scenarios.studies import study
from foreride.scenarios.studies.recipes import PACKAGES, read_recipe
from foreride.vehicle.load import load_vehicle

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs").rglob("*.md"))
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"# (\w+\.(?:py|yaml))\n")
READERS = {
    "scenarios": lambda name: study.read(Path(name)),
    "kind": load_vehicle,
    "behind_m": lambda name: strict.read(FmuControllerMap, name),
    "ssh": lambda name: [read_recipe(f"{name}:{kind}") for kind in PACKAGES],
}
"""Reader of a yaml block with this key at its top level, if it is no scenario."""
KNOWN = {"yaml", "python", "bash", "sh", "text"}


def blocks(page: Path) -> list[tuple[str, str]]:
    return BLOCK.findall(page.read_text(encoding="utf-8"))


def commands(text: str) -> list[list[str]]:
    return [
        shlex.split(line, comments=True) for line in text.replace("\\\n", " ").splitlines() if line.strip()
    ]


def pages(with_runs: bool) -> list[Path]:
    def runs(page: Path) -> bool:
        return any(kind in ("bash", "python", "yaml") for kind, _ in blocks(page))

    return [page for page in PAGES if "reference" not in page.parts and runs(page) == with_runs]


@pytest.mark.slow
@pytest.mark.parametrize("page", pages(with_runs=True), ids=lambda page: page.stem)
def test_blocks_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(FMUS_ALLOWED, "1")
    namespace: dict[str, object] = {"__name__": "page"}
    for kind, text in blocks(page):
        named = FILE.match(text)
        if named:
            Path(named[1]).write_text(text)
        if kind == "yaml":
            assert named, f"{page.name}: a yaml block must begin with its file's name"
            read = next((reader for key, reader in READERS.items() if f"\n{key}:" in text), load)
            read(named[1])
        elif kind == "python":
            exec(compile(text, f"{page.name}:{named[1] if named else 'block'}", "exec"), namespace)
            if named and named[1].startswith("test_"):
                command = [sys.executable, "-m", "pytest", "-q", named[1], "--ride-accept"]
                subprocess.run(command, check=True, capture_output=True)
        for line in commands(text) if kind == "bash" else ():
            assert line[0] == "foreride", line
            assert main(line[1:]) == 0, " ".join(line)


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md"], ids=lambda page: page.stem)
def test_kinds_of_blocks_are_known(page: Path) -> None:
    for kind, _ in blocks(page):
        assert kind in KNOWN, f"{page.name}: what should a test do with a {kind!r} block?"
