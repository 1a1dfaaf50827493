"""A replay of exact signals and images gives the preview of the drive itself."""

from collections.abc import Iterator
from dataclasses import fields

import cv2
import numpy as np

from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.perceptions.camera import build_estimator, load_detector
from foreride.scenarios.perceptions.image_band import image_band
from foreride.scenarios.replay.playback import replay
from foreride.scenarios.replay.recording import RecordedImage, Signals
from foreride.scenarios.simulation.simulate import Run, simulate
from foreride.vehicle.plant.sensors import SensorNoise

EXACT = [
    "road.length_m=24", "road.features.0.start_m=14", "vehicle.model=half", "camera.pitch_sigma_deg=0",
    "camera.height_sigma_m=0",
    *(f"sensors.{item.name}=0" for item in fields(SensorNoise) if item.name != "interface"),
]  # fmt: skip


def losslessly(run: Run) -> Iterator[RecordedImage]:
    for look in run.looks:
        assert look.image is not None
        done, data = cv2.imencode(".png", cv2.cvtColor(look.image, cv2.COLOR_RGB2BGR))
        assert done
        yield RecordedImage(look.tick / 1000, data.tobytes(), f"image {look.tick}")


def test_the_preview_is_that_of_the_drive() -> None:
    scenario = load("hump_flat_30", EXACT)
    run = simulate(Case(scenario, "skyhook", "camera", 2), keep_images=True)
    step = 1000 // scenario.control.rate_hz
    sampled = {name: values[::step] for name, values in run.signals.items()}
    detector = load_detector(scenario)
    estimator = build_estimator(scenario, detector.calibration)
    band = image_band(scenario, estimator.mount, detector)
    assert band.first_row == 128
    result = replay(
        Signals(sampled["time_s"], sampled, 0.0), losslessly(run), scenario, estimator, detector, band
    )
    assert len(result.looks) == len(run.looks)
    count = len(run.previews)
    assert count == len(result.previews) > 20
    assert np.abs(run.previews.height_m).max() > 0.05
    for name in ("time_s", "distance_m", "height_m", "position_sigma_m", "existence"):
        assert np.allclose(getattr(result.previews, name), getattr(run.previews, name), rtol=0, atol=1e-5)
