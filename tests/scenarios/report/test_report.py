"""The HTML report: complete, self-contained, honest about what is missing, and alive in a browser."""

import json
import re
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.cli import main
from foreride.scenarios.report.budget import error_budget_section
from foreride.scenarios.report.film import video
from foreride.scenarios.report.frames import with_frames
from foreride.scenarios.report.replay import encode_float32, spectra
from foreride.scenarios.runs.read import read

SHORT = """
title: A short <drive> over a hump
speed_kmh: 40
road:
  length_m: 20
  features:
    - {kind: flat_top_hump, start_m: 11, length_m: 3.6, height_m: 0.09, ramp_m: 0.6}
vehicle: {model: half}
"""


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a comparison: passive without a camera, preview with one whose images are not kept."""
    folder = tmp_path_factory.mktemp("compared")
    (folder / "short.yaml").write_text(SHORT)
    arguments = [str(folder / "short.yaml"), "--controllers", "passive,mpc_preview", "--perception", "camera"]
    assert main(["compare", *arguments, "--no-figures", "--out", str(folder / "runs")]) == 0
    assert main(["report", str(folder / "runs"), "--out", str(folder / "report.html")]) == 0
    return folder


def data_of(page: str) -> dict:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)
    assert found
    return json.loads(found[1])


def camera_run(folder: Path) -> Path:
    return folder / "runs" / "short-half-mpc_preview-camera-seed0"


def test_it_needs_nothing_from_elsewhere_and_is_small(compared: Path) -> None:
    page = (compared / "report.html").read_text()
    outside = re.findall(r"""(?:src|href)\s*=\s*["'](?!data:)|@import|url\(""", page)
    assert not outside
    assert len(page) < 15e6
    assert "{{" not in page
    assert "A short &lt;drive&gt; over a hump" in page


def test_it_shows_passive_beside_preview_with_all_that_belongs_to_them(compared: Path) -> None:
    (scene,) = data_of((compared / "report.html").read_text())["scenes"]
    passive, preview = scene["runs"]
    assert passive["label"] == "passive"
    assert scene["best"] == 1
    assert {"x", "heave", "pitch", "acc", "damping", "force", "front", "rear"} <= set(preview["signals"])
    assert "Rendered again" in preview["frames"]
    assert "without a camera" in passive["frames"]
    assert all("image" in look and "tracks" in look for look in preview["looks"])
    assert any(look["boxes"] for look in preview["looks"])
    assert preview["preview"]


def test_the_tables_tell_metrics_solver_and_manifest(compared: Path) -> None:
    page = (compared / "report.html").read_text()
    metrics = json.loads((camera_run(compared) / "metrics.json").read_text())
    manifest = json.loads((camera_run(compared) / "manifest.json").read_text())
    assert f"{metrics['wk_rms']:.3f}" in page
    assert f"<td>{manifest['solver']['solves']}<" in page
    assert manifest["scenario_hash"] in page
    assert manifest["weights_sha256"] in page


BUDGET = {
    "schema": 1,
    "vehicle": "half",
    "seeds": [0, 1],
    "table": [
        {
            "event": "hump <flat>",
            "reactive": 0.4,
            "whole": 0.25,
            "all_true": 0.2,
            "kept": 0.75,
            "rest": 0.05,
            "sources": [
                {"source": "latency", "replaced_by": "no latency", "objective": 0.24, "cost": 0.05},
                {"source": "detector", "replaced_by": "exact boxes", "objective": 0.22, "cost": 0.15},
            ],
        }
    ],
}


def test_a_budget_file_becomes_a_section_with_the_greatest_cost_first(compared: Path, tmp_path: Path) -> None:
    budget, out = tmp_path / "budget.json", tmp_path / "report.html"
    budget.write_text(json.dumps(BUDGET))
    source = [str(compared / "runs" / "short-half-passive-none-seed0"), "--out", str(out)]
    assert main(["report", *source, "--budget", str(budget)]) == 0
    section = out.read_text().split("Where the gain is lost")[1].split("</section>")[0]
    assert "hump &lt;flat&gt;" in section
    assert section.index("detector") < section.index("latency")
    assert "15.0%" in section
    assert "75%" in section


def test_a_budget_without_a_gain_shows_dashes(tmp_path: Path) -> None:
    nothing = json.loads(json.dumps(BUDGET))
    event = nothing["table"][0]
    event["kept"] = event["rest"] = None
    event["reactive"] = event["all_true"]
    for source in event["sources"]:
        source["cost"] = None
    (tmp_path / "budget.json").write_text(json.dumps(nothing))
    section = error_budget_section(tmp_path / "budget.json")
    assert section.count("<td>-</td>") == len(event["sources"]) + 2


@pytest.mark.parametrize("text", ["{", "{}", '{"table": [{"event": "x"}]}', '{"table": 3}'])
def test_a_malformed_budget_is_told_in_one_line(
    compared: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    budget, out = tmp_path / "budget.json", tmp_path / "report.html"
    budget.write_text(text)
    source = [str(compared / "runs" / "short-half-passive-none-seed0"), "--out", str(out)]
    assert main(["report", *source, "--budget", str(budget)]) == 2
    (told,) = capsys.readouterr().err.strip().splitlines()
    assert "budget.json: is not " in told
    assert not out.exists()


@pytest.mark.parametrize(
    ("place", "value"), [("event", 3), ("sources", [3]), ("sources", {"cost": 1}), ("rest", None)]
)
def test_a_budget_of_the_wrong_types_raises_nothing_but_an_input_error(
    tmp_path: Path, place: str, value: object
) -> None:
    budget = tmp_path / "budget.json"
    budget.write_text(json.dumps(BUDGET | {"table": [BUDGET["table"][0] | {place: value}]}))
    if place == "event":
        assert "<h3>3</h3>" in error_budget_section(budget)
        return
    with pytest.raises(InputError, match="is not a comfort budget"):
        error_budget_section(budget)


def test_a_map_has_its_place_among_the_perceptions(tmp_path: Path) -> None:
    """It is the best sight of its drive, and a rung of what the comfort budget compares."""
    lines = [f"{x:.1f},{0.06 * (9.0 < x < 9.6):.2f}" for x in np.arange(0, 30, 0.1)]
    (tmp_path / "map.csv").write_text("\n".join(["x_m,z_m", *lines]) + "\n")
    road = tmp_path / "mapped.yaml"
    road.write_text(SHORT.replace("half", "quarter") + "map: {file: map.csv}\n")
    seen = ["--controllers", "mpc_reactive,mpc_preview", "--perception", "oracle,map"]
    assert main(["compare", str(road), *seen, "--no-figures", "--out", str(tmp_path / "runs")]) == 0
    out = tmp_path / "report.html"
    assert main(["report", str(tmp_path / "runs"), "--out", str(out)]) == 0
    (scene,) = data_of(out.read_text())["scenes"]
    assert scene["runs"][scene["best"]]["label"] == "mpc_preview (map)"
    assert "map of the road" in out.read_text().split("Comfort budget")[1]


def test_a_single_run_gets_its_passive_car(compared: Path, tmp_path: Path) -> None:
    alone = tmp_path / "alone"
    shutil.copytree(camera_run(compared), alone / "run")
    out = tmp_path / "one.html"
    assert main(["report", str(alone / "run"), "--no-render", "--out", str(out)]) == 0
    (scene,) = data_of(out.read_text())["scenes"]
    (both,) = data_of((compared / "report.html").read_text())["scenes"]
    assert [run["label"] for run in scene["runs"]] == ["passive", "mpc_preview (camera)"]
    assert scene["runs"][0]["signals"] == both["runs"][0]["signals"]
    assert "Boxes and tracks only" in scene["runs"][1]["frames"]


def test_rendering_again_gives_what_the_detector_saw(compared: Path) -> None:
    """The true hump lies inside the box that the detector found in the image that was not kept."""
    run = with_frames(read(camera_run(compared)))
    assert all(look.image.shape == run.looks[0].image.shape for look in run.looks)
    from foreride.scenarios.perceptions.camera import load_detector

    detector = load_detector(run.case.scenario)
    look = max(run.looks, key=lambda look: len(look.detections))
    again = detector(look.image, look.first_row)
    assert look.first_row > 0
    assert np.allclose(again.boxes, look.detections.boxes, atol=1e-3)


def test_a_half_finished_comparison_is_marked_as_partial(compared: Path, tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    shutil.copytree(compared / "runs", runs)
    shutil.rmtree(runs / camera_run(compared).name)
    out = tmp_path / "partial.html"
    assert main(["report", str(runs), "--out", str(out)]) == 0
    page = out.read_text()
    assert "Partial result." in page
    assert f"{camera_run(compared).name} did not run" in page
    assert "Partial result." not in (compared / "report.html").read_text()


@pytest.mark.parametrize("damage", ["nothing", "half a run", "no report source"])
def test_what_cannot_be_reported_is_told_in_one_line(
    compared: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], damage: str
) -> None:
    source, out = tmp_path / "source", tmp_path / "report.html"
    if damage == "half a run":
        shutil.copytree(camera_run(compared), source)
        (source / "signals.parquet").unlink()
    elif damage == "no report source":
        source.mkdir()
    assert main(["report", str(source), "--out", str(out)]) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert not out.exists()


@pytest.mark.parametrize(("suffix", "codec"), [(".webm", b"VP80"), (".mp4", b"VP90")])
def test_the_film_shows_both_cars(
    suffix: str,
    codec: bytes,
    compared: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(video, "event_window", lambda run, **given: (900, 1000))  # ticks: 4 frames
    film, out = (tmp_path / "film").with_suffix(suffix), tmp_path / "report.html"
    asked = ["report", str(compared / "runs"), "--out", str(out), "--film"]
    assert main([*asked, str(film)]) == 0
    assert "FFMPEG" not in capfd.readouterr().err
    reader = cv2.VideoCapture(str(film))
    assert reader.get(cv2.CAP_PROP_FRAME_COUNT) == 4
    assert int(reader.get(cv2.CAP_PROP_FOURCC)).to_bytes(4, "little") == codec
    assert reader.read()[1].shape == (540, 960, 3)
    out.unlink()
    assert main([*asked, str(tmp_path / "film.avi")]) == 2
    assert "ends in .webm or .mp4, got '.avi'" in capfd.readouterr().err
    assert not out.exists()  # told before any work


def test_the_spectrum_of_a_sine_lies_at_its_frequency_and_holds_its_power() -> None:
    from dataclasses import dataclass

    @dataclass
    class Sine:
        signals: dict

    time = np.arange(8192) / 1000
    found = spectra([Sine({"seat_acc_0": 2.0 * np.sin(2 * np.pi * 10.0 * time)})])  # type: ignore[list-item]
    import base64

    frequency, density = (
        np.frombuffer(base64.b64decode(text), "<f4") for text in (found["f"], found["density"][0])
    )
    assert frequency[density.argmax()] == pytest.approx(10.0, abs=0.3)
    assert np.sum(density) * (frequency[1] - frequency[0]) == pytest.approx(2.0, rel=0.02)


def test_numbers_are_packed_as_little_endian_float32() -> None:
    assert encode_float32([1.0]) == "AACAPw=="
