"""Tests of the public interface: drives, comparisons, results with units, and what importing it loads."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

import foreride
from foreride import InputError
from foreride.comfort import METRICS

SHORT = {"vehicle.model": "quarter", "road": {"length_m": 20, "features[0]": {"start_m": 10}}}
HEAVY = {"casadi", "mujoco", "numba", "matplotlib", "numpy", "scipy", "cv2", "onnxruntime", "pyarrow", "yaml"}


class Soft:
    """Controller of low constant damping."""

    def __init__(self, vehicle: Any, timing: Any, damping_ns_m: float = 900.0) -> None:
        self.command = np.full(vehicle.wheels, damping_ns_m)

    def reset(self) -> None:
        pass

    def step(self, estimate: foreride.Estimate, preview: foreride.RoadPreview | None) -> np.ndarray:
        return self.command


@pytest.fixture(scope="module")
def passive() -> foreride.Result:
    return foreride.run("bump_8x40_30", "passive", "none", overrides=SHORT)


def test_every_public_name_is_there_and_importing_foreride_loads_no_library() -> None:
    code = "import sys, foreride; print(*sys.modules); print(*dir(foreride)); from foreride import *"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded, names = (line.split() for line in done.stdout.splitlines())
    assert not HEAVY & set(loaded)
    assert set(names) == set(foreride.__all__)
    assert sorted(foreride._PLACES) == sorted(foreride.__all__)
    for name in foreride.__all__:
        assert getattr(foreride, name).__doc__
    with pytest.raises(AttributeError, match="has no attribute 'drive'"):
        foreride.drive  # noqa: B018


def test_a_result_has_metrics_and_a_unit_for_every_signal(passive: foreride.Result) -> None:
    assert passive.metrics["objective"] > 1.0
    assert (passive.controller, passive.perception, passive.seed) == ("passive", "none", 0)
    assert passive.fallbacks == 0
    lengths = {len(values) for values in passive.signals.values()}
    assert lengths == {passive.scenario.ticks + 1}
    assert passive.units.keys() == passive.signals.keys()
    assert all(passive.units.values())
    assert (passive.units["seat_acc_0"], passive.units["damping_0"]) == ("m/s²", "N·s/m")


@pytest.mark.parametrize("car", ["quarter", "half", "full"])
def test_the_signals_of_every_car_have_units(car: str) -> None:
    overrides = {"vehicle.model": car, "road.length_m": 20, "road.features": []}
    result = foreride.run("bump_8x40_30", "passive", "none", overrides=overrides)
    assert {"s", "m", "m/s", "m/s²", "rad", "rad/s", "rad/s²", "N", "N·s/m"} == set(result.units.values())


def test_tables_of_a_result_hold_values_and_units(passive: foreride.Result) -> None:
    table = passive.to_arrow()
    assert table.schema.field("seat_acc_0").metadata == {b"unit": "m/s²".encode()}
    assert np.array_equal(table["seat_acc_0"].to_numpy(), passive.signals["seat_acc_0"])
    frame = passive.to_pandas()
    assert frame.index.name == "time_s"
    assert frame.attrs["units"]["seat_acc_0"] == "m/s²"
    assert np.array_equal(frame["seat_acc_0"].to_numpy(), passive.signals["seat_acc_0"])


def test_a_saved_result_is_read_back(passive: foreride.Result, tmp_path: Path) -> None:
    again = foreride.load_run(passive.save(tmp_path / "run"))
    assert again.metrics == passive.metrics
    assert np.array_equal(again.signals["seat_acc_0"], passive.signals["seat_acc_0"])
    assert repr(again) == repr(passive)
    schema = pq.read_schema(tmp_path / "run" / "signals.parquet")
    assert schema.field("seat_acc_0").metadata == {b"unit": "m/s²".encode()}


def test_results_show_themselves_in_notebooks(passive: foreride.Result) -> None:
    view = passive._repr_html_()
    assert view.count("<polyline") == 2
    assert "seat_acc_0: -" in view
    assert "<td>objective</td>" in view
    assert f"<td>{METRICS.parts()['wk_rms'].definition}</td>" in view
    comparison = foreride.Comparison((passive,))._repr_html_()
    assert "<th>controller</th>" in comparison
    assert "<td>passive</td>" in comparison


def test_a_comparison_drives_classes_objects_and_names(tmp_path: Path) -> None:
    stiff = Soft(foreride.load_vehicle("quarter"), None, 2000.0)
    stiff.__class__ = type("Stiff", (Soft,), {})
    compared = foreride.compare("bump_8x40_30", ["passive", Soft, stiff], ["oracle"], overrides=SHORT)
    assert [result.controller for result in compared] == ["passive", "Soft", "Stiff"]
    assert [result.perception for result in compared] == ["none", "oracle", "oracle"]
    soft = foreride.run("bump_8x40_30", Soft, overrides=SHORT)
    assert soft.metrics == compared.results[1].metrics
    assert len({result.metrics["objective"] for result in compared}) == 3
    assert compared.baseline == "passive"
    assert "J / passive" in compared.to_markdown()
    assert "toprule" in compared.to_latex()
    assert compared.to_arrow()["controller"].to_pylist() == ["passive", "Soft", "Stiff"]
    assert list(compared.to_pandas()["objective"]) == [result.metrics["objective"] for result in compared]
    assert compared.save(tmp_path / "runs").is_dir()
    assert foreride.report(tmp_path / "runs", tmp_path / "a.html").read_text().startswith("<!")
    assert compared.report(tmp_path / "b.html").stat().st_size > 10_000


@pytest.mark.slow
def test_worker_processes_change_no_result() -> None:
    names = ["passive", "skyhook"]
    one, two = (foreride.compare("bump_8x40_30", names, overrides=SHORT, jobs=jobs) for jobs in (1, 2))
    assert [result.metrics for result in one] == [result.metrics for result in two]


def test_a_study_is_completed_in_this_process(tmp_path: Path) -> None:
    study = tmp_path / "study.yaml"
    study.write_text(
        "scenarios: [bump_8x40_30]\ncontrollers: [passive]\n"
        "set: {vehicle.model: quarter, road.length_m: 20, 'road.features[0].start_m': 10}\n"
        "vary: {speed_kmh: {values: [30, 40]}}\n"
    )
    table = foreride.sweep(study, tmp_path / "out")
    assert table["set.speed_kmh"].to_pylist() == [30, 40]
    assert all(value > 0 for value in table["objective"].to_pylist())
    assert foreride.sweep(study, tmp_path / "out").equals(table)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: foreride.run("bump"), "scenario 'bump' is neither a file nor in the library"),
        (lambda: foreride.run("bump_8x40_30", "skyhok"), "controller must be one of"),
        (lambda: foreride.run("bump_8x40_30", perception="sonar"), "perception must be one of"),
        (lambda: foreride.run("bump_8x40_30", seed=-1), "seed"),
        (lambda: foreride.run("bump_8x40_30", overrides={"speed": {"kmh": 1}}), "speed"),
        (lambda: foreride.run("bump_8x40_30", 5), "must have reset() and step()"),  # type: ignore[arg-type]
        (lambda: foreride.compare("bump_8x40_30", [Soft, Soft]), "must have different names, got Soft, Soft"),
        (lambda: foreride.compare("bump_8x40_30", baseline="pasive"), "baseline must be one of passive,"),
        (lambda: foreride.compare("bump_8x40_30", jobs=0), "jobs"),
        (lambda: foreride.load_run("nowhere"), "nowhere"),
        (
            lambda: foreride.load_scenario(foreride.load_scenario("bump_8x40_30"), {"seed": 1}),
            "already loaded",
        ),
    ],
)
def test_invalid_input_is_refused_in_one_line(call: Any, told: str) -> None:
    with pytest.raises(InputError) as caught:
        call()
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)
