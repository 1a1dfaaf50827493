"""Camera perceptions of the closed loop: true boxes with errors, or rendered images through the detector."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from foreride.detector.box_errors import SIMULATED_CALIBRATION, degrade
from foreride.detector.calibration import Calibration
from foreride.detector.detections import exact, no_detections
from foreride.preview.estimator import Estimator
from foreride.preview.height.stereo import second_pose
from foreride.preview.prior_drives.memory_file import Memory
from foreride.preview.prior_drives.memory_file import read as read_memory
from foreride.preview.road_preview import distance_grid
from foreride.preview.vehicle_facts import VehicleFacts
from foreride.road.camera.pinhole import CameraMount, CameraPose, pose_of
from foreride.road.render.outline_boxes import Outlines
from foreride.road.tyre.contact_models import Enveloping
from foreride.road.tyre.tyre import Tyre
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.perceptions.detector_perception import BoxSource, DetectionStage, DetectorPerception
from foreride.scenarios.perceptions.ground_truth_substitution import track_corrector
from foreride.scenarios.perceptions.image_band import image_band
from foreride.scenarios.perceptions.interface import Drive, Exposure, ReferencedFile
from foreride.vehicle.corner_inertia import corner_inertia
from foreride.vehicle.load import Car
from foreride.vehicle.state import VehicleState

if TYPE_CHECKING:  # ONNX Runtime and the renderer are slow to import, and boxes need neither
    from foreride.detector.runtime import Detector

MIN_HEIGHT_M = 0.05
"""Height of the lowest camera that calibration errors make of a low one."""
_SECOND_CAMERA_OFFSET = 1 << 40  # offset of the tick that seeds the second camera's image noise


def build_boxes(drive: Drive) -> DetectorPerception:
    """Build the perception `boxes` of a drive."""
    mount = true_mount(drive.scenario, drive.random_stream("mounting"))
    return _with_estimator(drive, true_box_source(drive.scenario, mount, drive.random_stream("boxes")))


def build_camera(drive: Drive) -> DetectorPerception:
    """Build the perception `camera` of a drive."""
    scenario, mount = drive.scenario, true_mount(drive.scenario, drive.random_stream("mounting"))
    detector = load_detector(scenario)
    camera = RenderedCamera(scenario, mount, drive.random_stream("image"), drive.keep_images)
    detection = DetectionStage(detector, image_band(scenario, nominal_mount(scenario), detector))
    return _with_estimator(drive, camera.expose, detection)


def _with_estimator(
    drive: Drive, eye: BoxSource, detection: DetectionStage | None = None
) -> DetectorPerception:
    """Perception from the exposures of `eye` by the scenario's estimator."""
    scenario, setup = drive.scenario, drive.scenario.camera
    calibration = detection.detector.calibration if detection else SIMULATED_CALIBRATION
    estimator = build_estimator(scenario, calibration)
    correct = track_corrector(scenario.road.features, scenario.told)
    return DetectorPerception(
        eye, estimator, setup.rate_hz, setup.latency_s, drive.keep_images, correct, detection
    )


def build_estimator(scenario: Scenario, calibration: Calibration) -> Estimator:
    """Build the estimator of a scenario's car and camera, for boxes of a detector of this calibration."""
    car, setup = scenario.vehicle.parameters, scenario.camera
    return Estimator(
        setup.intrinsics,
        nominal_mount(scenario),
        car.axle_x_m,
        car.wheel_y_m,
        scenario.estimator,
        x_m=scenario.start_m,
        distance_m=distance_grid(ahead_m=scenario.preview_m),
        memory=_memory(scenario),
        stereo_base_m=setup.stereo_base_m,
        calibration=calibration,
        facts=vehicle_facts(car, scenario.enveloping),
    )


def vehicle_facts(car: Car, enveloping: Enveloping) -> VehicleFacts:
    """Facts of a car, which its maker knows, for the estimator."""
    stiffness = np.array([corner.tyre_n_m for corner in car.corners])
    return VehicleFacts(
        tyre_compliance=corner_inertia(car) / stiffness[:, None],
        static_deflection_m=car.corners[0].static_tyre_deflection_m,
        tyre=Tyre(car.wheel_radius_m, enveloping),
    )


def nominal_mount(scenario: Scenario) -> CameraMount:
    """Camera mounting that the estimator assumes."""
    return scenario.camera.mount(max(scenario.vehicle.parameters.axle_x_m))


def true_mount(scenario: Scenario, rng: np.random.Generator) -> CameraMount:
    """Actual camera mounting: the nominal one with calibration errors, at least `MIN_HEIGHT_M` over the
    road.
    """
    nominal = nominal_mount(scenario)
    pitch, height = rng.standard_normal(2)
    return replace(
        nominal,
        pitch_deg=nominal.pitch_deg + scenario.camera.pitch_sigma_deg * float(pitch),
        height_m=max(MIN_HEIGHT_M, nominal.height_m + scenario.camera.height_sigma_m * float(height)),
    )


def load_detector(scenario: Scenario) -> "Detector":
    """Load the detector with the scenario's weights and threshold."""
    from foreride.detector.runtime import WEIGHTS

    wanted = scenario.detection
    weights = WEIGHTS if wanted.weights is None else Path(wanted.weights)
    written_ns = weights.stat().st_mtime_ns if weights.exists() else 0
    return _session(weights, wanted.threads, wanted.confidence, wanted.backend, written_ns)


@lru_cache(maxsize=4)
def _session(weights: Path, threads: int, confidence: float, backend: str, written_ns: int) -> "Detector":
    """Return one detector shared by all runs of a process; `written_ns` detects a changed file."""
    from foreride.detector.runtime import Detector

    return Detector(weights, threads, confidence, backend=backend)


def _memory(scenario: Scenario) -> Memory | None:
    """Memory of an earlier drive, if the scenario names one."""
    return None if scenario.memory is None else read_memory(scenario.memory)


WEIGHTS_FILE = ReferencedFile("weights_sha256", lambda scenario: load_detector(scenario).path, load_detector)
"""The detector's weights."""
MEMORY_FILE = ReferencedFile("memory_sha256", lambda scenario: scenario.memory, _memory)
"""The memory of an earlier drive, for the estimator."""


def pose(mount: CameraMount, state: VehicleState) -> CameraPose:
    """Camera pose for the sprung mass in `state`."""
    attitude = float(state.heave_m), float(state.pitch_rad)
    return pose_of(mount, float(state.x_m), *attitude, roll=float(state.roll_rad))


def true_box_source(scenario: Scenario, mount: CameraMount, rng: np.random.Generator) -> BoxSource:
    """Box source: true outlines with the scenario's box errors."""
    camera, errors = scenario.camera.intrinsics, scenario.boxes
    size_px, outlines = (camera.width_px, camera.height_px), Outlines(scenario.road)

    def look(tick: int, state: VehicleState, first_row: int) -> Exposure:
        boxes = exact(*outlines.boxes(camera, pose(mount, state), errors.range_m))
        return Exposure(tick, degrade(boxes, size_px, errors, rng))

    return look


class RenderedCamera:
    """Rendered camera, or stereo pair, of a scenario.

    whole: whether rows that are not looked at are rendered too, which changes no other row.
    """

    def __init__(
        self, scenario: Scenario, mount: CameraMount, rng: np.random.Generator, whole: bool = False
    ) -> None:
        from foreride.road.render.scene import Scene

        self._setup, self._mount, self._whole = scenario.camera, mount, whole
        seed = int(rng.integers(2**31))
        self._scene = Scene(scenario.road, scenario.appearance, seed, threads=scenario.detection.threads)
        self._yaw = np.deg2rad(self._setup.stereo_yaw_sigma_deg) * float(rng.standard_normal())

    def expose(self, tick: int, state: VehicleState, first_row: int) -> Exposure:
        """Exposure without detections, of rows from `first_row` on."""
        started = perf_counter()
        left = pose(self._mount, state)
        image = self._render(left, tick, 0 if self._whole else first_row)
        second = None
        if self._setup.stereo_base_m > 0.0:
            right = second_pose(left, self._setup.stereo_base_m)
            right = replace(right, yaw=right.yaw + self._yaw)
            second = self._render(right, tick + _SECOND_CAMERA_OFFSET, first_row)
        return Exposure(tick, no_detections(), image, second, perf_counter() - started, first_row)

    def _render(self, camera_pose: CameraPose, index: int, first_row: int) -> np.ndarray:
        return self._scene.render(self._setup.intrinsics, camera_pose, index, first_row=first_row).image
