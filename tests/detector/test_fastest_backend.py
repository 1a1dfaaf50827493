"""Tests of the choice of the fastest backend."""

import json
from pathlib import Path

import pytest

from foreride.detector import fastest_backend as fastest
from foreride.detector.runtime import WEIGHTS, Detector


@pytest.fixture
def measured(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[dict[str, float]]:
    """Measurements still to come, last first, with an empty cache and two backends."""
    monkeypatch.setenv("FORERIDE_CACHE", str(tmp_path))
    monkeypatch.setattr(fastest, "installed", lambda: ["cpu", "openvino"])
    times: list[dict[str, float]] = []
    monkeypatch.setattr(fastest, "measured", lambda *given: times.pop())
    return times


def test_cpu_is_kept_unless_another_is_clearly_faster() -> None:
    assert fastest.choice({"cpu": 20.0, "openvino": 19.0}) == "cpu"
    assert fastest.choice({"cpu": 20.0, "openvino": 17.0, "openvino-bf16": 12.0}) == "openvino-bf16"
    assert fastest.choice({"cpu": 20.0}) == "cpu"


def test_the_choice_is_measured_once_and_kept(measured: list[dict[str, float]], tmp_path: Path) -> None:
    measured.append({"cpu": 20.0, "openvino": 10.0})
    assert fastest.fastest_backend(WEIGHTS, 2, 640) == "openvino"
    assert fastest.fastest_backend(WEIGHTS, 2, 640) == "openvino"
    (file,) = (tmp_path / "backends").iterdir()
    assert json.loads(file.read_text())["median_ms"] == {"cpu": 20.0, "openvino": 10.0}
    measured.append({"cpu": 5.0, "openvino": 10.0})
    assert fastest.fastest_backend(WEIGHTS, 1, 640) == "cpu"


@pytest.mark.parametrize("content", ["", "[]", '{"backend": "npu"}', '{"backend": 3}'])
def test_a_damaged_entry_of_the_cache_is_measured_again(
    measured: list[dict[str, float]], tmp_path: Path, content: str
) -> None:
    measured.append({"cpu": 20.0, "openvino": 10.0})
    fastest.fastest_backend(WEIGHTS, 2, 640)
    (file,) = (tmp_path / "backends").iterdir()
    file.write_text(content)
    measured.append({"cpu": 5.0, "openvino": 10.0})
    assert fastest.fastest_backend(WEIGHTS, 2, 640) == "cpu"


def test_nothing_is_measured_where_only_onnxruntime_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fastest, "installed", lambda: ["cpu"])
    assert Detector(backend="fastest").backend == "cpu"


def test_bfloat16_is_left_out_where_the_processor_has_none(
    measured: list[dict[str, float]], monkeypatch: pytest.MonkeyPatch
) -> None:
    names: list[str] = []

    def measure(path: Path, chosen: list[str], *given: object) -> dict[str, float]:
        names.extend(chosen)
        return {"cpu": 1.0}

    monkeypatch.setattr(fastest, "installed", lambda: ["cpu", "openvino", "openvino-bf16"])
    monkeypatch.setattr(fastest, "computes_bf16", lambda: False)
    monkeypatch.setattr(fastest, "measured", measure)
    fastest.fastest_backend(WEIGHTS, 2, 640)
    assert names == ["cpu", "openvino"]


def test_a_measurement_times_every_backend_in_turn() -> None:
    times_ms = fastest.measured(WEIGHTS, ["cpu", "no such backend"], 1, (64, 64))
    assert list(times_ms) == ["cpu"]
    assert times_ms["cpu"] > 0.0
