"""`foreride doctor`: self-test of the installation, one check per component of the loop."""

import argparse
import os
import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np

from foreride.controller.interface import Timing
from foreride.controller.observer.exact_observer import exact_estimate
from foreride.controller.registry import build
from foreride.detector.runtime import Detector
from foreride.files.cache import cached, writable
from foreride.files.compiled import CACHE, PACKAGES, SOURCE
from foreride.files.writing.atomic import write_text
from foreride.preview.road_preview import flat_preview
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of
from foreride.road.features.feature import HalfSineBump
from foreride.road.render.appearance import Appearance
from foreride.road.render.scene import Scene
from foreride.road.road import Road
from foreride.scenarios.commands.console import console, verdict
from foreride.scenarios.commands.options import add_output_options
from foreride.scenarios.definition.loading import load, names
from foreride.scenarios.runs.write import to_json, versions
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.state_layout import state_layout


@dataclass(frozen=True)
class Finding:
    """Result of one check: whether it passed, with details."""

    check: str
    passed: bool
    detail: str


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    add_output_options(command)
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Print one line per check; exit code 1 if one failed."""
    console.print(f"{platform.platform()}, {os.cpu_count()} cores")
    console.print(", ".join(f"{name} {version}" for name, version in versions().items()))
    findings = []
    for check in CHECKS:
        finding = _try(check)
        findings.append(finding)
        console.print(verdict(finding.passed), f"{finding.check}: {finding.detail}")
    passed = all(finding.passed for finding in findings)
    if arguments.json:
        document = {
            "passed": passed,
            "versions": versions(),
            "checks": [vars(finding) for finding in findings],
        }
        write_text(arguments.json, to_json(document) + "\n")
    return 0 if passed else 1


def _try(check: Callable[[], str]) -> Finding:
    title = (check.__doc__ or check.__name__).strip().rstrip(".")
    try:
        return Finding(title, True, check())
    except Exception as error:  # report any failure
        return Finding(title, False, f"{type(error).__name__}: {error}".splitlines()[0])


def _library() -> str:
    """Scenario library."""
    scenarios = [load(name) for name in names()]
    assert scenarios, "no scenario files"
    return f"{len(scenarios)} scenarios are valid"


def _plant() -> str:
    """MuJoCo plant."""
    for name in ("quarter_car", "half_car"):
        car = load_vehicle(name)
        plant = Plant(car)
        flat = _Flat()
        plant.reset([flat] * car.wheels, 0.0, 10.0)
        plant.step(np.full(car.wheels, 1500.0), 200)
        drift = float(np.abs(plant.state.x[state_layout(car).motion]).max())
        assert drift < 1e-6, f"{name} leaves its equilibrium by {drift:g}"
    return "quarter and half car stay in equilibrium on a flat road"


def _solver() -> str:
    """Model predictive controller."""
    car = load_vehicle("quarter_car")
    plant = Plant(car)
    plant.reset([_Flat()], 0.0, 10.0)
    controller = build("mpc_preview", car, None, Timing())
    for _ in range(5):
        controller.step(exact_estimate(plant.state), flat_preview(1, plant.state.time_s))
        plant.step(np.array([1500.0]), 10)
    stats = controller.stats
    assert stats["fallbacks"] == 0, f"fallbacks: {stats['reasons']}"
    return f"{stats['solves']} solves, no fallback"


def _renderer_and_detector() -> str:
    """Renderer and detector."""
    road = Road(40.0, (HalfSineBump(start_m=12.0, height_m=0.08, length_m=0.4, paint="yellow_black"),))
    camera, pose = Camera(), pose_of(CameraMount(), 2.0, 0.0, 0.0)
    frame = Scene(road, Appearance(), 1).render(camera, pose, 0)
    second_frame = Scene(road, Appearance(), 1).render(camera, pose, 0)
    assert np.array_equal(frame.image, second_frame.image), "the same frame was rendered twice and differs"
    detector = Detector(threads=1)
    detections = detector(frame.image)
    assert (detections.classes == 0).any(), "the shipped detector does not find a plain bump 10 m ahead"
    return f"frames repeat; bump found with score {detections.scores[detections.classes == 0].max():.2f}"


class _Flat:
    def height(self, x: np.ndarray, /) -> np.ndarray:
        return np.zeros_like(x)

    def slope(self, x: np.ndarray, /) -> np.ndarray:
        return np.zeros_like(x)


def _caches() -> str:
    """Caches."""
    compiled_folders = [CACHE / package for package in PACKAGES] if CACHE == SOURCE else [CACHE]
    folders_by_cache = {
        "compiled code": [folder for folder in compiled_folders if folder is not None],
        "kernels": [cached("kernels/any").parent],
        "bounds": [cached("bounds/any").parent],
        "backends": [cached("backends/any").parent],
        "figures": [Path(matplotlib.get_cachedir())],
    }
    return "; ".join(f"{name} {_described(folders)}" for name, folders in folders_by_cache.items())


def _described(folders: Sequence[Path]) -> str:
    if not folders:
        return "nowhere, as no folder can be written"
    patterns = ("*.nb[ci]", "*.o", "*.npz", "*.json")
    files = (file for folder in folders for pattern in patterns for file in folder.rglob(pattern))
    size = sum(file.stat().st_size for file in files)
    usable = "writable" if all(map(writable, folders)) else "read-only"
    return f"in {' and '.join(map(_shortened, folders))}, {usable}, {size / 2**20:.1f} MiB"


def _shortened(folder: Path) -> str:
    home = _home()
    return f"~/{folder.relative_to(home)}" if home and folder.is_relative_to(home) else str(folder)


def _home() -> Path | None:
    try:
        return Path.home()
    except RuntimeError:  # neither HOME nor an entry in the list of users
        return None


CHECKS = (_library, _plant, _solver, _renderer_and_detector, _caches)
