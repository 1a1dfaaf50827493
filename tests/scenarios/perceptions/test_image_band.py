"""Tests of the band of the image that is looked at."""

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any

import numpy as np
import pytest

from foreride.detector.runtime import Detector
from foreride.preview.ego_motion.ego_motion import EgoState
from foreride.road.camera.pinhole import pose_of, project
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.perceptions import detector_perception
from foreride.scenarios.perceptions.camera import load_detector, nominal_mount
from foreride.scenarios.perceptions.image_band import ImageBand, image_band, looked_at
from foreride.scenarios.runs.write import to_json
from foreride.scenarios.simulation.simulate import Run, simulate

SHORT = [
    "road.length_m=18", "road.features.0.start_m=13", "vehicle.model=half", "camera.stereo_base_m=0.3",
    "camera.rate_hz=10", "camera.latency_s=0.15",
]  # fmt: skip


def band_of(*overrides: str) -> ImageBand:
    scenario = load("hump_flat_30", overrides)
    return image_band(scenario, nominal_mount(scenario), load_detector(scenario))


def test_the_band_of_the_default_camera_holds_the_road_and_256_rows() -> None:
    band = band_of()
    assert band.first_row == 128
    pose = pose_of(band.mount, 0.0, 0.0, 0.0)
    rows = project(band.camera, pose, [(x, 0.0, 0.15) for x in (5.0, 35.0, 300.0)])[:, 1]
    assert rows.min() > band.first_row + 14


@pytest.mark.parametrize(
    ("overrides", "row"),
    [
        (["detection.above_horizon_deg=90"], 0),
        (["detection.above_horizon_deg=9"], 64),
        (["camera.pitch_deg=30"], 0),
        (["camera.pitch_deg=-10", "detection.above_horizon_deg=0"], 256),
        (["camera.intrinsics.width_px=1280", "camera.intrinsics.height_px=720"], 256),
        (["camera.intrinsics.width_px=653"], 0),
    ],
)
def test_the_band_begins_on_the_grid_of_the_network(overrides: list[str], row: int) -> None:
    assert band_of(*overrides).first_row == row


def test_a_pitch_that_lifts_the_horizon_to_the_edge_of_the_band_shows_the_whole_image() -> None:
    band, level = band_of(), EgoState(1.0, 5.0, 0.0, 0.0, 10.0)
    assert band.at(None) == band.at(level) == 128
    assert band.at(level._replace(pitch_rad=np.deg2rad(1.4))) == 128
    assert band.at(level._replace(pitch_rad=np.deg2rad(1.6))) == 0
    assert band.at(level._replace(pitch_rad=np.deg2rad(-5.0))) == 128


def test_rows_that_are_not_looked_at_are_black_in_a_copy() -> None:
    image = np.full((96, 64, 3), 7, np.uint8)
    band = looked_at(image, 32)
    assert band is not None
    assert (band[:32] == 0).all()
    assert (band[32:] == 7).all()
    assert (image == 7).all()
    assert looked_at(image, 0) is image
    assert looked_at(None, 32) is None


def drive(keep_images: bool) -> Run:
    return simulate(Case(load("hump_flat_30", SHORT), "mpc_preview", "camera", 1), keep_images)


@pytest.fixture(scope="module")
def kept() -> Run:
    return drive(keep_images=True)


def test_kept_images_are_whole_and_change_nothing(kept: Run) -> None:
    seen = drive(keep_images=False)
    assert seen.metrics == kept.metrics
    assert to_json(seen.events) == to_json(kept.events)
    assert all(look.first_row == 128 for look in kept.looks)
    image = kept.looks[0].image
    assert image is not None
    assert image[:100].std() > 3.0


def test_rendering_while_detecting_changes_nothing(kept: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(detector_perception, "ThreadPoolExecutor", OneAfterTheOther)
    one_by_one = drive(keep_images=False)
    assert one_by_one.metrics == kept.metrics
    assert to_json(one_by_one.events) == to_json(kept.events)


class OneAfterTheOther(Executor):
    """Executor that does each work when it is given."""

    def __init__(self, threads: int) -> None:
        """Start no thread."""

    def submit(self, work: Callable[..., Any], /, *given: Any, **named: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(work(*given, **named))
        return future


def test_boxes_in_the_band_are_those_of_the_whole_image_within_a_tolerance(kept: Run) -> None:
    """Attention over all positions makes the band inexact; edges that give distances are hardly affected."""
    detector = Detector(threads=2)
    look = max(kept.looks, key=lambda look: look.detections.scores.max(initial=0.0))
    assert look.image is not None
    whole, band = detector(look.image), detector(look.image, 128)
    assert np.array_equal(band.boxes, look.detections.boxes)
    assert np.abs(whole.boxes[0, 1::2] - band.boxes[0, 1::2]).max() < 0.5
    assert np.abs(whole.boxes[0] - band.boxes[0]).max() < 8.0
    assert abs(whole.scores[0] - band.scores[0]) < 0.1
