"""A few kills, faults, extreme drives and minutes; the modules beside this one go on for as long as asked."""

import random
import re
import subprocess
import sys
from pathlib import Path

import pytest

from foreride.scenarios.commands.drive.bound import ACTUATORS
from tests.robustness.drives import CONTROLLERS, Trial, driven, every_edge, trial
from tests.robustness.soak import Sample, growth, soak
from tests.robustness.state import problems, state_of

ROOT = Path(__file__).parents[2]


def run(module: str, *arguments: str) -> str:
    """What the module prints when nothing is wrong."""
    command = [sys.executable, "-m", f"tests.robustness.{module}", *arguments]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_a_kill_leaves_the_old_or_the_new() -> None:
    told = run("kill_points", "--points", "12", "--commands", "run,sweep,report", "--seed", "1")
    assert "12 kill points, 0 of them with findings" in told


def test_commands_end_well_on_a_system_that_refuses() -> None:
    faults = "files of 100 bytes at most,read-only,stdout a broken pipe,umask 077,few open files,no home"
    assert "6 faults, 0 with findings" in run("faults", "--commands", "run", "--faults", faults)


def test_a_torn_or_missing_file_is_told(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text("{}")
    (tmp_path / "b.json").write_text("{}")
    before = state_of(tmp_path)
    after = before | {"a.json": {"": b"[]"}}
    assert problems(tmp_path, before, after) == []
    (tmp_path / "a.json").write_text("[")
    (tmp_path / "b.json").unlink()
    (tmp_path / "c.json").write_text("{}")
    told = sorted(problems(tmp_path, before, after))
    assert [line.split(":")[0] for line in told] == ["a.json", "b.json", "c.json"]
    assert "neither old nor whole" in told[0]
    assert "the old one is gone" in told[1]


@pytest.mark.parametrize("actuator", ACTUATORS)
def test_every_law_drives_a_car_with_every_actuator(actuator: str) -> None:
    for controller in CONTROLLERS:
        one = driven(Trial("half", actuator, (), controller, "none"))
        assert one.told == "", str(one)


@pytest.mark.parametrize("seed", range(10))
def test_extreme_values_that_are_allowed_can_be_driven(seed: int) -> None:
    one = trial(random.Random(seed))
    assert one.told in ("", "refused", "long"), str(one)


def test_a_number_at_the_end_of_its_range_can_be_driven() -> None:
    edges = list(every_edge())
    assert len(edges) > 200
    rng = random.Random(2)
    for path, up in rng.sample(edges, 10):
        one = trial(rng, path, up)
        assert one.told in ("", "refused", "long"), str(one)


def test_a_soak_counts_what_the_process_holds() -> None:
    (sample, *_) = soak(0.0, 0, 60.0, lambda sample: None)
    assert sample.drives == 1
    assert sample.rss_mib > 50
    samples = [Sample(k, 1000 * k, 100.0 + 2 * max(0, k - 4), 9, 1) for k in range(8)]
    assert growth(samples) == pytest.approx(2.0)


def test_the_long_runs_say_how_they_are_started() -> None:
    for module in ("kill_points", "faults", "soak", "drives"):
        assert re.search(r"usage: python -m tests\.robustness\.", run(module, "--help"))
