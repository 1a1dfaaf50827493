"""Tests that the documentation builds without warnings and its reference pages match the code."""

import re
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest

import foreride
from foreride.comfort import METRICS
from foreride.scenarios import reference_docs
from foreride.scenarios.api_reference import api_page
from foreride.scenarios.cli import parser
from foreride.scenarios.column_reference import column_page
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.schema import Scenario

DOCS = Path(__file__).resolve().parents[2] / "docs"


def test_every_field_of_a_scenario_is_on_its_page() -> None:
    page = reference_docs.scenario_page()
    for _, block in reference_docs.blocks(Scenario):
        for item in fields(block):
            assert not item.init or f"| `{item.name}` |" in page
    for place in ("road.features: pothole", "camera.intrinsics", "control.settings.mpc"):
        assert f"\n## {place}\n" in page
    assert (
        "| `depth_m` | number | 0.0001 ... 0.5 m | **required** | depth of the floor under the road. |"
        in page
    )


def test_blocks_follow_the_mapping_of_a_scenario() -> None:
    """Each block of a written scenario is one of those described, by its dotted path."""
    described = {path.partition(":")[0] for path, _ in reference_docs.blocks(Scenario)}

    def paths(mapping: dict, path: str = "") -> set[str]:
        inner = {f"{path}.{key}".strip("."): value for key, value in mapping.items()}
        inner = {place: value for place, value in inner.items() if isinstance(value, dict)}
        return set(inner).union(*(paths(value, place) for place, value in inner.items()))

    assert paths(load("mixed_40").mapping) - {"control.settings.user", "vehicle.map"} <= described


def test_every_public_name_is_on_the_page_of_the_interface() -> None:
    page = api_page()
    for name in foreride.__all__:
        section = page.partition(f"\n## {name}\n")[2].partition("\n## ")[0]
        assert len(section.split("```")[2].strip()) > 20, name
    assert "* `to_latex(columns: Sequence[str] | None = None) -> str`: " in page
    assert "ndarray[" not in page


def test_no_page_names_a_constant_of_the_code() -> None:
    """A reader cannot look it up: its value belongs there."""
    generated = (reference_docs.scenario_page(), reference_docs.metric_page(), api_page(), column_page())
    written = (page.read_text() for page in DOCS.rglob("*.md") if "reference" not in page.parts)
    for text in (*generated, *written):
        prose = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
        names = re.findall(r"\b[A-Z]{2,}_[A-Z_]+\b", prose)
        assert [name for name in names if not name.startswith(("FORERIDE_", "NUMBA_", "ELLIPS_"))] == []


def test_every_command_and_metric_is_on_its_page() -> None:
    page = reference_docs.command_page()
    commands = parser()._subparsers._group_actions[0].choices  # type: ignore[union-attr]
    for name in commands:
        assert f"## foreride {name}" in page
    assert not any("|" in metric.definition for metric in METRICS.own.values())
    assert all(
        f"| `{name}` | {metric.definition} |" in reference_docs.metric_page()
        for name, metric in METRICS.own.items()
    )


@pytest.mark.slow
def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    build = ["-q", "-W", "--keep-going", "-b", "html"]
    command = [sys.executable, "-m", "sphinx", *build, str(DOCS), str(tmp_path)]
    result = subprocess.run(command, capture_output=True, text=True, cwd=DOCS.parent)
    assert result.returncode == 0, result.stderr
    for page in ("index", "quickstart", "physics", "validation", "reference/scenario", "reference/commands"):
        assert (tmp_path / f"{page}.html").is_file()
