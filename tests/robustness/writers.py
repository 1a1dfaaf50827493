"""Every command that writes, small enough to be run hundreds of times."""

import json
import shutil
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from foreride.road.camera.pinhole import Camera
from tests.detector.roads import write as write_images
from tests.fuzz.road_readers import STUDY
from tests.road.boards import photograph, poses

WORK = "work"
"""Folder within the place of a command into which it writes, and in which it is started."""


@dataclass(frozen=True)
class Writer:
    """arguments: of the command, started in `WORK`; inputs lie in the folder above, under `old` and `new`.

    In each argument `{}` stands for one of these two, so that both runs have the same targets.
    prepare: changes to the program that make it quick, in the process of the command. once: whether it
    refuses a target that is there.
    """

    arguments: tuple[str, ...]
    prepare: Callable[[], None] = lambda: None
    once: bool = False

    def command(self, version: str) -> list[str]:
        """The arguments with the inputs of that version."""
        return [argument.replace("{}", f"../{version}") for argument in self.arguments]


def _quick_demo() -> None:
    from foreride.scenarios.commands.drive import demo

    demo.SCENARIOS = ("../new/short.yaml",)


def _sweep_in_this_process() -> None:
    from foreride.scenarios.commands.drive import sweep
    from foreride.scenarios.studies import results
    from foreride.scenarios.studies.sweep import simulate_sample

    @contextmanager
    def cluster(*given, **named):  # type: ignore[no-untyped-def]
        yield None

    def run(client, samples, kept, advance) -> None:  # type: ignore[no-untyped-def]
        for sample in samples:
            kept.add(simulate_sample(sample))
            advance()

    sweep.cluster, sweep.run = cluster, run
    results.ROWS_PER_PART = 3


def _quick_bound() -> None:
    from foreride.controller.clairvoyant.optimum import Optimum
    from foreride.controller.clairvoyant.single_shooting import WholeDriveObjective
    from foreride.scenarios.bound import optimum_cache

    def optimise(car, whole: WholeDriveObjective, plans) -> Optimum:  # type: ignore[no-untyped-def]
        found = {name: whole.objective(plan)[0] for name, plan in plans.items()}
        best = min(found, key=found.__getitem__)
        return Optimum(plans[best], found[best], found)

    optimum_cache.optimise = optimise


_PASSIVE = ("--controllers", "passive")
_TRAIN = ("--stages", "64x64:1", "--model", "yolo11n", "--batch", "2", "--device", "cpu", "--workers", "0")

WRITERS: dict[str, Writer] = {
    "run": Writer(("run", "{}/short.yaml", *_PASSIVE, "--out", "runs", "--json", "a.json", "--parquet",
                   "a.parquet", "--markdown", "a.md", "--latex", "a.tex")),
    "run with memory": Writer(("run", "{}/short.yaml", "--controllers", "mpc_preview", "--perception",
                               "boxes", "--out", "runs", "--frames")),
    "compare": Writer(("compare", "{}/short.yaml", "--controllers", "passive,skyhook", "--out", "runs",
                       "--no-figures", "--json", "a.json")),
    "demo": Writer(("demo", "--out", "demo"), _quick_demo),
    "render": Writer(("render", "{}/short.yaml", "--every", "1", "--out", "images", "--json", "a.json")),
    "report": Writer(("report", "{}/compared", "--out", "report.html", "--no-render")),
    "log": Writer(("log", "{}/compared/short-quarter-passive-none-seed1", "--out", "a.mcap", "--mf4",
                   "a.mf4")),
    "replay": Writer(("replay", "{}/recording.csv", "--images", "{}/recorded", "--scenario",
                      "{}/short.yaml", "--out", "replayed", "--json", "a.json")),
    "fmu": Writer(("fmu", "export", "vehicle", "{}/short.yaml", "--code", "c", "--out", "a.fmu")),
    "sweep": Writer(("sweep", "{}/study.yaml", "--out", "study", "--jobs", "1", "--json", "a.json"),
                    _sweep_in_this_process),
    "regress": Writer(("regress", "{}/short.yaml", "--accept", *_PASSIVE, "--baseline", "baseline.json")),
    "bound": Writer(("bound", "{}/short.yaml", "--json", "a.json"), _quick_bound),
    "tune": Writer(("tune", "{}/short.yaml", "--controllers", "skyhook", "--evaluations", "8", "--out",
                    "tuned.yaml", "--json", "a.json")),
    "perception": Writer(("perception", "{}/short.yaml", "--perception", "boxes", "--json", "a.json")),
    "road": Writer(("road", "{}/short.yaml", "--json", "a.json")),
    "calibrate": Writer(("calibrate", *(f"{{}}/board{k}.png" for k in range(4)), "--squares", "9x6",
                         "--square_m", "0.03", "--out", "camera.yaml", "--json", "a.json")),
    "detector data": Writer(("detector", "data", "--out", "set", "--train", "1", "--val", "1", "--test",
                             "1")),
    "detector boxes": Writer(("detector", "boxes", "{}/images", "--json", "a.json")),
    "detector convert": Writer(("detector", "convert", "{}/images", "converted"), once=True),
    "detector convert to COCO": Writer(("detector", "convert", "{}/images", "coco.json")),
    "detector eval": Writer(("detector", "eval", "--data", "{}/images", "--json", "a.json", "--out",
                             "scores")),
    "detector mine": Writer(("detector", "mine", "{}/plain", "--out", "mined", "--confidence", "0.01")),
    "detector train": Writer(("detector", "train", "--data", "{}/split", "--out", "training", *_TRAIN)),
    "detector blend": Writer(("detector", "blend", "shipped", "{}/weights.pt", "--out", "blended.pt")),
    "detector export": Writer(("detector", "export", "--weights", "{}/weights.pt", "--out", "a.onnx")),
}  # fmt: skip

SLOW = ("demo", "detector data", "detector train", "detector blend", "detector export")


def place_inputs(folder: Path, version: str, speed_kmh: int) -> None:
    """Small inputs of all commands; those of `old` and `new` differ, their names do not."""
    folder.mkdir(parents=True)
    short = _scenario(speed_kmh)
    (folder / "short.yaml").write_text(json.dumps(short))
    study = STUDY.replace("bump_8x40_30", "short.yaml").replace("20, 30", "50, 60, 70, 80")
    (folder / "study.yaml").write_text(study)
    write_images(folder / "images", 2, seed=speed_kmh)
    for split in ("train", "val"):
        write_images(folder / "split" / split, 2, seed=speed_kmh)
    _boards(folder, speed_kmh)
    _recording(folder, speed_kmh)
    write_images(folder / "plain", 2, seed=speed_kmh)
    shutil.rmtree(folder / "plain" / "labels")


def _scenario(speed_kmh: int) -> dict[str, object]:
    bump = {"kind": "half_sine_bump", "start_m": 8, "height_m": 0.05, "length_m": 0.5}
    return {
        "name": "short", "title": "Kurze Strecke – ²", "speed_kmh": speed_kmh, "seed": 1,
        "road": {"length_m": 12, "features": [bump]}, "vehicle": {"model": "quarter"},
        "camera": {"intrinsics": {"width_px": 128, "height_px": 96, "focal_px": 92.0}},
    }  # fmt: skip


def _boards(folder: Path, seed: int) -> None:
    for number, pose in enumerate(poses(4, np.random.default_rng(seed))):
        cv2.imwrite(str(folder / f"board{number}.png"), photograph(Camera(focal_px=500.0), *pose))


def _recording(folder: Path, speed_kmh: int) -> None:
    """A quarter of a second of signals, and two images of the camera in the scenario."""
    head = "time_s,speed_m_s,body_acc_0,wheel_acc_0,rattle_m_0"
    rows = [f"{0.005 * k:.3f},{speed_kmh / 3.6:.3f},0,0,0" for k in range(50)]
    (folder / "recording.csv").write_text("\n".join([head, *rows]) + "\n")
    (folder / "recorded").mkdir()
    for time_ms in (100, 200):
        cv2.imwrite(str(folder / "recorded" / f"{time_ms}.png"), np.full((96, 128, 3), speed_kmh, np.uint8))


def fresh(place: Path, source: Path) -> None:
    """The state before a command as a copy of `source`."""
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(source, place, symlinks=True)
