"""Tests of the example regression test, run as by a user."""

import shutil
import subprocess
import sys
from pathlib import Path

import yaml

from foreride.scenarios.regression.baseline import read

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "regression"


SESSION = """
import pytest
assert pytest.main(["-q", "ride"]) == pytest.ExitCode.TESTS_FAILED
assert pytest.main(["-q", "ride", "--ride-accept"]) == pytest.ExitCode.OK
assert pytest.main(["-q", "ride"]) == pytest.ExitCode.OK
"""


def test_the_example_asks_for_baselines_records_them_and_then_holds(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLE, tmp_path / "ride")
    shutil.rmtree(tmp_path / "ride" / "ride_baselines")
    command = [sys.executable, "-c", SESSION]
    told = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    assert told.count("yet; pytest --ride-accept writes it") >= 2
    assert "pytest_plugin.py" not in told
    assert len(list((tmp_path / "ride" / "ride_baselines").iterdir())) == 2


def test_the_committed_baselines_of_the_example_can_be_read() -> None:
    assert all(read(path).entries for path in (EXAMPLE / "ride_baselines").iterdir())


def test_the_workflow_is_valid_yaml_that_runs_foreride() -> None:
    workflow = yaml.safe_load((EXAMPLE / "github_actions.yml").read_text())
    commands = [step.get("run", "") for step in workflow["jobs"]["ride"]["steps"]]
    assert any(command.startswith("foreride regress") for command in commands)
