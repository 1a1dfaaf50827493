"""Tests of the regression check: verdicts, messages and rejected baselines."""

import json
import math
from pathlib import Path

import pytest

from foreride.files.errors import InputError
from foreride.scenarios.cli import main
from foreride.scenarios.pytest_plugin import RideComfort
from foreride.scenarios.regression.baseline import read
from foreride.scenarios.regression.tolerances import Tolerance, change_lines, changes, failed, tolerance_of

SHORT = """
title: A short drive
speed_kmh: 40
road:
  length_m: 12
  features:
    - {kind: half_sine_bump, start_m: 5, height_m: 0.05, length_m: 0.5}
vehicle: {model: quarter}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "short.yaml").write_text(SHORT)
    return tmp_path


def accepted(folder: Path) -> Path:
    path = folder / "ride.json"
    arguments = [str(folder / "short.yaml"), "--controllers", "passive,skyhook", "--accept"]
    assert main(["regress", *arguments, "--baseline", str(path)]) == 0
    return path


def edited(path: Path, **metrics: float) -> None:
    """Scale metrics of the first case of a baseline file."""
    document = json.loads(path.read_text())
    for name, factor in metrics.items():
        document["cases"][0]["metrics"][name] *= factor
    path.write_text(json.dumps(document))


def test_a_change_is_judged_by_the_larger_of_both_tolerances() -> None:
    allowed = tolerance_of("wk_rms")
    assert allowed.of(0.1) == allowed.absolute
    assert allowed.of(10.0) == pytest.approx(10.0 * allowed.relative)
    assert not changes({"wk_rms": 10.0}, {"wk_rms": 10.099}, {})
    (found,) = changes({"wk_rms": 10.0}, {"wk_rms": 10.2}, {})
    assert found.used == pytest.approx(2.0)
    assert failed([found])


def test_an_own_tolerance_takes_the_place_of_the_usual_one() -> None:
    assert not changes({"wk_rms": 10.0}, {"wk_rms": 10.2}, {"wk_rms": Tolerance(0.3)})
    assert changes({"wk_rms": 10.0}, {"wk_rms": 10.02}, {"wk_rms": Tolerance(0.01)})


def test_better_and_neutral_changes_are_told_but_do_not_fail() -> None:
    before = {"wk_rms": 1.0, "damper_energy": 700.0, "lift_time": 0.02}
    found = changes(before, {"wk_rms": 0.8, "damper_energy": 800.0, "lift_time": 0.02}, {})
    assert {change.metric: change.verdict for change in found} == {
        "wk_rms": "better",
        "damper_energy": "changed",
    }
    assert not failed(found)


@pytest.mark.parametrize("after", [{}, {"wk_rms": math.nan}])
def test_a_metric_that_is_gone_or_no_number_fails(after: dict[str, float]) -> None:
    assert failed(changes({"wk_rms": 1.0}, after, {}))


def test_the_worst_is_told_first_with_its_share_of_the_tolerance() -> None:
    before = {"wk_rms": 1.0, "rattle_peak": 0.05, "vdv": 2.0}
    lines = change_lines(changes(before, {"wk_rms": 1.02, "rattle_peak": 0.06, "vdv": 1.0}, {}))
    assert lines[0] == "worse   rattle_peak   50 → 60 mm (+10: 10.0 × its tolerance of 1)"
    assert [line.split()[1] for line in lines] == ["rattle_peak", "wk_rms", "vdv"]


def document(foreride: str = "0.1", tolerances: str = "{}", cases: str = "[]") -> str:
    manifest = f'{{"versions": {{"foreride": "{foreride}"}}}}'
    return f'{{"schema": 1, "manifest": {manifest}, "tolerances": {tolerances}, "cases": {cases}}}'


def case(**changed: str) -> str:
    fields = {"scenario": '"short"', "set": "[]", "controller": '"passive"', "perception": '"none"'}
    fields |= {"seed": "0", "metrics": '{"vdv": 1}'} | changed
    return "[{" + ", ".join(f'"{name}": {value}' for name, value in fields.items()) + "}]"


def test_what_was_accepted_holds_and_what_got_worse_fails(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = accepted(folder)
    assert main(["regress", "--baseline", str(path)]) == 0
    edited(path, wk_rms=0.9, vdv=1.2)
    numbers = folder / "diff.json"
    assert main(["regress", "--baseline", str(path), "--json", str(numbers)]) == 1
    told = capsys.readouterr().out
    assert "FAILED short · passive · none · seed 0" in told
    assert "worse   wk_rms" in told
    assert "1 hold, 1 got worse" in told
    first, second = json.loads(numbers.read_text())["rows"]
    assert first["failed"]
    assert {change["metric"] for change in first["changes"]} == {"wk_rms", "vdv"}
    assert not second["changes"]
    assert main(["regress", "--baseline", str(path), "--accept"]) == 0
    assert main(["regress", "--baseline", str(path)]) == 0


def test_the_scenario_is_found_from_wherever_the_check_is_started(
    folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    monkeypatch.chdir(folder)
    accepted(Path())
    assert read(Path("ride.json")).entries[0].scenario == "short.yaml"
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    assert main(["regress", "--baseline", str(folder / "ride.json")]) == 0


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{", "is not valid JSON"),
        ("[]", "another version"),
        ('{"schema": 2}', "another version"),
        ('{"schema": 1}', "manifest"),
        (document(foreride="99.0"), "99.0"),
        (document(cases="[{}]"), "scenario"),
        (document(tolerances='{"vdv": -1}'), "-1"),
        (document(tolerances='{"vdv": Infinity}'), "must be finite, got Infinity"),
        (document(tolerances="[" * 5000 + "]" * 5000), "is nested"),
        (document(cases=case(metrics="{}")), "cases[0].metrics must hold at least one metric"),
        (document(cases=case(metrics='{"vdv": 1e999}')), "must be finite, got '1e999'"),
        (document(cases=case(seed="1.5")), "cases[0].seed must be a whole number, got 1.5"),
        (document(cases=case(seed="-1")), "cases[0].seed must be >= 0, got -1"),
        (document(cases=case(set='["speed"]')), "cases[0].set: --set 'speed': must read path.to.field=value"),
        (document(cases=case(set='"speed"')), "cases[0].set must be a list, got 'speed'"),
    ],
)
def test_a_baseline_that_is_none_or_of_another_version_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, told: str
) -> None:
    path = tmp_path / "ride.json"
    path.write_text(text)
    assert main(["regress", "--baseline", str(path)]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert "ride.json" in lines[0]
    assert told in lines[0]
    assert path.read_text() == text


@pytest.mark.parametrize(
    ("before", "after"), [(math.nan, 1.0), (1.0, math.nan), (math.inf, 1.0), (1.0, math.inf)]
)
def test_a_metric_that_is_no_number_is_a_failure_and_told_first(before: float, after: float) -> None:
    found = changes({"vdv": before, "wk_rms": 1.0}, {"vdv": after, "wk_rms": 9.0}, {})
    assert [(change.metric, change.verdict) for change in found] == [("vdv", "worse"), ("wk_rms", "worse")]
    assert failed(found)
    assert len(change_lines(found)) == 2


def test_a_backend_that_depends_on_the_machine_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = folder / "ride.json"
    words = [str(folder / "short.yaml"), "--accept", "--set", "detection.backend=fastest"]
    assert main(["regress", *words, "--baseline", str(path)]) == 2
    assert not path.exists()
    assert "detection.backend must be named in a baseline, got fastest" in capsys.readouterr().err


def test_a_missing_baseline_is_refused(tmp_path: Path) -> None:
    assert main(["regress", "--baseline", str(tmp_path / "none.json")]) == 2


def test_the_fixture_accepts_then_holds_then_tells_what_got_worse(folder: Path) -> None:
    file = folder / "ride_baselines" / "test.json"
    with pytest.raises(pytest.fail.Exception, match="--ride-accept"):
        RideComfort(file, accept=False)("short.yaml", "passive")
    RideComfort(file, accept=True)("short.yaml", "passive")
    run = RideComfort(file, accept=False)("short.yaml", "passive")
    assert run.metrics == {n: v for n, v in read(file).entries[0].metrics.items() if n != "fallbacks"}
    edited(file, tyre_load_rms=0.8)
    with pytest.raises(pytest.fail.Exception, match=r"worse +tyre_load_rms"):
        RideComfort(file, accept=False)("short.yaml", "passive")
    RideComfort(file, accept=False)("short.yaml", "passive", tolerances={"tyre_load_rms": 1.0})


def test_a_metric_that_the_baseline_lacks_is_said_and_does_not_fail(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = changes({"wk_rms": 1.0}, {"wk_rms": 2.0, "rattle_peak": 0.04}, {})
    assert [change.verdict for change in found] == ["worse", "new"]
    assert change_lines(found)[1] == "new     rattle_peak   40 mm (not in the baseline)"
    file = folder / "ride_baselines" / "test.json"
    RideComfort(file, accept=True)("short.yaml", "passive")
    document = json.loads(file.read_text())
    del document["cases"][0]["metrics"]["vdv"]
    file.write_text(json.dumps(document))
    with pytest.warns(UserWarning, match="lacks vdv; pytest --ride-accept adds it"):
        RideComfort(file, accept=False)("short.yaml", "passive")
    document["cases"][0]["scenario"] = str(folder / "short.yaml")
    (own := folder / "own.json").write_text(json.dumps(document))
    assert main(["regress", "--baseline", str(own)]) == 0
    told = capsys.readouterr().out
    assert "new     vdv" in told
    assert "1 hold, 0 got worse, 0 moved otherwise; the baseline lacks metrics of 1" in told


def test_a_broken_baseline_is_an_input_error_for_the_fixture_too(folder: Path) -> None:
    file = folder / "ride_baselines" / "test.json"
    file.parent.mkdir()
    file.write_text('{"schema": 7}')
    with pytest.raises(InputError, match="another version"):
        RideComfort(file, accept=False)("short.yaml", "passive")
