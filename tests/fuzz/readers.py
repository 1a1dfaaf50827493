"""Every reader of a data file with a small valid file for it: the table that tests and fuzzing go through.

`READERS[name].place(folder)` writes a valid input under an empty folder and gives the file in it that is to
be damaged; `READERS[name].read(file)` reads it, with what lies beside it. A reader may return or raise
InputError, in bounded time and memory, whatever that file holds; anything else is a mistake of the program.
"""

import json
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import cv2
import numpy as np

from tests.fuzz import networks

ROOT = Path(__file__).parents[2]
BOXES = np.array([[[10.0, 40.0, 60.0, 50.0], [20.0, 60.0, 40.0, 70.0]]], np.float32)
SCORES = np.array([[[0.9, 0.0], [0.0, 0.6]]], np.float32)


@dataclass(frozen=True)
class Reader:
    """place: folder → file in it. read: that file → anything; InputError for bad input."""

    place: Callable[[Path], Path]
    read: Callable[[Path], object]


def _text(name: str, text: str) -> Callable[[Path], Path]:
    return _data(name, text.encode())


def _data(name: str, data: bytes) -> Callable[[Path], Path]:
    def place(folder: Path) -> Path:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        return path

    return place


def _copy(name: str, source: str) -> Callable[[Path], Path]:
    return _data(name, (ROOT / source).read_bytes())


# --- Roads and maps ---------------------------------------------------------------------------------------

CSV = "x_m,left_m,right_m\n0.0,0.0,0.0\n0.5,0.01,0.02\n1.0,0.0,0.01\n1.5,0.0,0.0\n"
MAP = (
    "x_m,left_m,right_m,height_sigma_m,position_sigma_m,existence\n"
    "0.0,0.0,0.0,0.004,0.05,1\n0.5,0.01,0.02,0.004,0.05,1\n1.0,0.0,0.01,0.004,0.05,0.9\n"
)
CRG = """$CT
a hand-written road
$
$ROAD_CRG
reference_line_start_u = 0.0
reference_line_end_u = 1.0
reference_line_increment = 0.5
long_section_v_right = -1.0
long_section_v_left = 1.0
long_section_v_increment = 2.0
$
$KD_DEFINITION
#:LRFI
U:reference line u,m,0.0,0.5
D:long section 1,m
D:long section 2,m
$
$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$
 0.0000000 0.0000000
 0.0100000-0.0200000
 0.0300000 0.0400000
"""


def _road(path: Path) -> object:
    from foreride.road.io.surface_file import read_surface

    return read_surface(path)


def _map(path: Path) -> object:
    from foreride.preview.prior_drives.road_map import read

    return read(path)


# --- YAML ---------------------------------------------------------------------------------------------------

STUDY = """
scenarios: [bump_8x40_30]
controllers: [passive]
seeds: [0, 1]
set: {vehicle.model: quarter}
vary: {speed_kmh: [20, 30]}
"""


def _scenario(path: Path) -> object:
    from foreride.scenarios.definition.loading import load

    return load(str(path))


def _vehicle(path: Path) -> object:
    from foreride.vehicle.load import load_vehicle

    return load_vehicle(path)


def _memory_file(folder: Path) -> Path:
    from foreride.preview.prior_drives.memory_file import (
        TEMPLATE_BY_NAME,
        Memory,
        Mounting,
        RememberedObject,
        RowBias,
        write,
    )

    mounting = Mounting(0.01, 0.02, 1e-4, 0.0, 1e-4)
    bump = RememberedObject(
        next(iter(TEMPLATE_BY_NAME)), 20.0, 0.1, 0.4, 0.1, 0.08, 0.02, -1.5, 1.5, 0.2, 0.9
    )
    rows = RowBias((1.0, -1.0), (0.5, 0.5), 0.0, (0.0, 0.0), (0.0, 0.0))
    write(folder / "memory.yaml", Memory(mounting, (bump,), rows))
    return folder / "memory.yaml"


def _memory(path: Path) -> object:
    from foreride.preview.prior_drives.memory_file import read

    return read(path)


def _study(path: Path) -> object:
    from foreride.scenarios.studies.study import read

    return read(path)


def _settings(path: Path) -> object:
    from foreride.scenarios.commands.options import settings_overrides

    return settings_overrides(path)


# --- Images and data sets -----------------------------------------------------------------------------------


def picture(suffix: str) -> bytes:
    """A small photograph."""
    image = np.random.default_rng(0).integers(0, 256, (24, 32, 3), dtype=np.uint8)
    return bytes(cv2.imencode(suffix, cv2.resize(image, (64, 48)))[1])


def _image(path: Path) -> object:
    from foreride.detector.data.image_io import read_image

    return read_image(path)


def _photo(path: Path) -> object:
    from foreride.scenarios.commands.inspect.calibrate import _photo

    return _photo(path)


RECORD = {
    "image": "a.png",
    "road": 1,
    "condition": {
        "light": "day", "weather": "dry", "low_sun": False, "motion_blur_px": 0.0, "surface": "asphalt",
        "verge": "grass", "surroundings": "rural",
    },
    "objects": [
        {"class": 0, "kind": "half_sine_bump", "paint": "none", "distance_m": 9.0, "in_ego_lane": True,
         "hidden": 0.0}
    ],
}  # fmt: skip
MANIFEST = {
    "counts": {"train": 1, "val": 0, "test": 0},
    "label_minimum": {"height_px": 4, "width_px": 8, "pixels": 30},
    "seed": 1,
    "hash": "abc",
}


def data_set(folder: Path) -> Path:
    """A rendered data set of one image, in the split `train`."""
    split = folder / "train"
    for inner in ("images", "labels", "lane"):
        (split / inner).mkdir(parents=True)
    (split / "images" / "a.png").write_bytes(picture(".png"))
    (split / "lane" / "a.png").write_bytes(bytes(cv2.imencode(".png", np.full((48, 64), 255, np.uint8))[1]))
    (split / "labels" / "a.txt").write_text("0 0.5 0.5 0.25 0.25\n")
    (split / "objects.jsonl").write_text(json.dumps(RECORD) + "\n")
    (folder / "dataset.json").write_text(json.dumps(MANIFEST))
    return split


def _in_set(name: str) -> Callable[[Path], Path]:
    return lambda folder: data_set(folder) / name


def _split_of(path: Path) -> Path:
    return path.parent if (path.parent / "images").is_dir() else path.parent.parent


def _labels(path: Path) -> object:
    from foreride.detector.data.yolo_folder import read_labels

    return read_labels(path)


def _records(path: Path) -> object:
    from foreride.detector.data.yolo_folder import read_records

    return read_records(path.parent)


def _evaluated(path: Path) -> object:
    from foreride.detector.detections import Detections
    from foreride.detector.evaluation.evaluate import evaluate

    found = Detections(BOXES[0], SCORES[0].max(1), np.array([0, 1]))
    return evaluate(_split_of(path), lambda image: found, 0.5)


def _card(path: Path) -> object:
    from foreride.road.dataset.dataset_card import write_card

    return write_card(path.parent if path.name == "dataset.json" else path.parent.parent, {})


def _boxes(path: Path) -> object:
    from foreride.road.dataset.label_statistics import box_statistics

    return box_statistics(_split_of(path))


COCO = {
    "images": [{"id": 1, "file_name": "a.png", "width": 64, "height": 48}],
    "annotations": [{"id": 1, "image_id": 1, "category_id": 1, "bbox": [4, 4, 20, 10], "iscrowd": 0}],
    "categories": [{"id": 1, "name": "pothole"}],
}


def _coco_file(folder: Path) -> Path:
    (folder / "a.png").write_bytes(picture(".png"))
    return _text("coco.json", json.dumps(COCO))(folder)


def _coco(path: Path) -> object:
    from foreride.detector.data.yolo_coco import read_coco

    return read_coco(path, path.parent, {})


# --- Networks -----------------------------------------------------------------------------------------------

HISTORY = {"passes": 10, "size": "64x64", "loss": {"box": 1.0}, "map50": 0.5, "map50_95": 0.3, "recall": 0.5}


def _curves(path: Path) -> object:
    from foreride.detector.evaluation.plots import write_curves

    return write_curves(path.parent)


def _weights_file(folder: Path) -> Path:
    import torch

    from foreride.detector.network.checkpoint import save_weights

    torch.manual_seed(0)
    save_weights(folder / "weights.pt", torch.nn.Linear(2, 2), {"model": "linear", "passes": 1})
    return folder / "weights.pt"


def _weights(path: Path) -> object:
    import torch

    from foreride.detector.network.checkpoint import load_weights

    return load_weights(path, torch.nn.Linear(2, 2))


def _network_file(folder: Path) -> Path:
    return networks.write(folder / "network.onnx", BOXES, SCORES)


def _network(path: Path) -> object:
    from foreride.detector.runtime import Detector

    return Detector(path)(np.zeros((64, 96, 3), np.uint8))


# --- Results ------------------------------------------------------------------------------------------------

BASELINE = {
    "schema": 1,
    "manifest": {"versions": {"foreride": "0.0.1"}},
    "tolerances": {"objective": 0.1},
    "cases": [
        {"scenario": "bump_8x40_30", "set": ["speed_kmh=20"], "controller": "passive", "perception": "none",
         "seed": 0, "metrics": {"objective": 1.0}}
    ],
}  # fmt: skip
EVENT = {
    "event": "bump",
    "reactive": 0.9,
    "whole": 0.5,
    "all_true": 0.4,
    "rest": 0.1,
    "kept": 0.8,
    "sources": [{"source": "pitch", "replaced_by": "truth", "cost": 0.1, "objective": 0.45}],
}
BUDGET = {"schema": 1, "vehicle": "half", "seeds": [0], "table": [EVENT]}


@cache
def _run_folder() -> Path:
    """The folder of a short drive that a camera with true boxes has seen, with its frames."""
    from foreride.scenarios.cases import Case
    from foreride.scenarios.definition.loading import load
    from foreride.scenarios.runs.write import row, to_json, write
    from foreride.scenarios.simulation.simulate import simulate

    short = ["road.length_m=8", "road.features.0.start_m=7", "vehicle.model=quarter", "speed_kmh=60"]
    run = simulate(Case(load("bump_8x40_30", short), "mpc_preview", "boxes", 0))
    folder = Path(mkdtemp(prefix="foreride-fuzz-"))
    write(run, folder / "run")
    (folder / "run" / "frames").mkdir()
    for look in run.looks:
        (folder / "run" / "frames" / f"{look.tick:07d}.jpg").write_bytes(picture(".jpg"))
    (folder / "comparison.json").write_text(to_json({"schema": 1, "planned": [], "rows": [row(run)]}))
    return folder


def _in_run(name: str) -> Callable[[Path], Path]:
    def place(folder: Path) -> Path:
        shutil.copytree(_run_folder() / "run", folder, dirs_exist_ok=True)
        return folder / name

    return place


def _comparison_file(folder: Path) -> Path:
    return Path(shutil.copy(_run_folder() / "comparison.json", folder / "comparison.json"))


def _frame_file(folder: Path) -> Path:
    return min((_in_run("frames")(folder)).iterdir())


def _run(path: Path) -> object:
    from foreride.files.writing.marker import seal
    from foreride.scenarios.runs.read import read
    from foreride.scenarios.runs.write import KIND

    folder = path.parent.parent if path.parent.name == "frames" else path.parent
    if path.is_file():
        seal(folder, KIND)  # what is wrong in it shall not be found by its checksum alone
    return read(folder)


def _baseline(path: Path) -> object:
    from foreride.scenarios.regression.baseline import read

    return read(path)


def _budget(path: Path) -> object:
    from foreride.scenarios.report.budget import error_budget_section

    return error_budget_section(path)


def _comparison(path: Path) -> object:
    from foreride.scenarios.report.gather import gather
    from foreride.scenarios.report.html import page

    return page(gather(path))


def _results_row(key: str) -> dict[str, object]:
    return {"key": key, "error": None, "scenario": "bump", "metrics.objective": 1.0}


def _part_file(folder: Path) -> Path:
    from foreride.scenarios.studies.results import Results

    results = Results(folder)
    results.add(_results_row("a"))
    results.flush()
    return folder / "part-00000.parquet"


def _results(path: Path) -> object:
    from foreride.files.writing.marker import seal
    from foreride.scenarios.studies.results import KIND, Results, load_results

    if path.is_file():
        seal(path.parent, KIND)
    return Results(path.parent).done, load_results(path.parent) if path.suffix == ".parquet" else None


READERS: dict[str, Reader] = {
    "road.csv": Reader(_text("road.csv", CSV), _road),
    "road.crg": Reader(_text("road.crg", CRG), _road),
    "map.csv": Reader(_text("map.csv", MAP), _map),
    "scenario": Reader(_copy("scenario.yaml", "scenarios/library/bump_8x40_30.yaml"), _scenario),
    "vehicle": Reader(_copy("vehicle.yaml", "vehicle/parameters/half_car.yaml"), _vehicle),
    "memory": Reader(_memory_file, _memory),
    "study": Reader(_text("study.yaml", STUDY), _study),
    "settings": Reader(_text("settings.yaml", "mpc: {horizon_s: 0.8}\n"), _settings),
    "image.png": Reader(_data("image.png", picture(".png")), _image),
    "image.jpg": Reader(_data("image.jpg", picture(".jpg")), _image),
    "image.webp": Reader(_data("image.webp", picture(".webp")), _image),
    "image.bmp": Reader(_data("image.bmp", picture(".bmp")), _image),
    "photograph": Reader(_data("photo.jpg", picture(".jpg")), _photo),
    "labels": Reader(_text("labels.txt", "0 0.5 0.5 0.25 0.25\n1 0.2 0.2 0.1 0.1\n"), _labels),
    "records": Reader(_in_set("objects.jsonl"), _records),
    "evaluated labels": Reader(_in_set("labels/a.txt"), _evaluated),
    "evaluated records": Reader(_in_set("objects.jsonl"), _evaluated),
    "lane mask": Reader(_in_set("lane/a.png"), _evaluated),
    "card's manifest": Reader(_in_set("../dataset.json"), _card),
    "card's records": Reader(_in_set("objects.jsonl"), _card),
    "boxes' labels": Reader(_in_set("labels/a.txt"), _boxes),
    "boxes' image": Reader(_in_set("images/a.png"), _boxes),
    "coco": Reader(_coco_file, _coco),
    "history": Reader(_text("history.jsonl", json.dumps(HISTORY) + "\n"), _curves),
    "weights": Reader(_weights_file, _weights),
    "network": Reader(_network_file, _network),
    "run's manifest": Reader(_in_run("manifest.json"), _run),
    "run's metrics": Reader(_in_run("metrics.json"), _run),
    "run's events": Reader(_in_run("events.jsonl"), _run),
    "run's signals": Reader(_in_run("signals.parquet"), _run),
    "run's previews": Reader(_in_run("previews.parquet"), _run),
    "run's frame": Reader(_frame_file, _run),
    "comparison": Reader(_comparison_file, _comparison),
    "baseline": Reader(_text("baseline.json", json.dumps(BASELINE)), _baseline),
    "budget": Reader(_text("budget.json", json.dumps(BUDGET)), _budget),
    "sweep's journal": Reader(_text("journal.jsonl", json.dumps(_results_row("a")) + "\n"), _results),
    "sweep's part": Reader(_part_file, _results),
}
