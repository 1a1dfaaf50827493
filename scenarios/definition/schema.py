"""Scenario schema: frozen dataclasses of a scenario file, read strictly by `files.reading.strict`."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Any, Literal

from annotated_types import Interval

from foreride.controller.interface import Timing
from foreride.controller.mpc.time_grid import graded_grid
from foreride.controller.settings import ControllerSettings
from foreride.controller.speed.settings import PreviewPlanner, SpeedPlanner
from foreride.detector.box_errors import BoxErrors
from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.files.reading.ranges import Checked, Seed
from foreride.files.writing.names import check_name
from foreride.preview.elevation.range_sensor import LidarSolidState, Sensor
from foreride.preview.elevation.settings import ElevationSettings
from foreride.preview.road_preview import PREVIEW_M
from foreride.preview.settings import Settings as EstimatorSettings
from foreride.road.camera.pinhole import Camera, CameraMount
from foreride.road.render.appearance import Appearance
from foreride.road.road import Road
from foreride.road.tyre.contact_models import Enveloping, RigidWheel
from foreride.scenarios.definition.applicability import require_applicable
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.definition.faults import Fault
from foreride.scenarios.definition.oracle_errors import OracleErrors
from foreride.scenarios.definition.speed import KM_H, SpeedPoint, profile
from foreride.vehicle.load import Car
from foreride.vehicle.plant.difference import PlantDifference
from foreride.vehicle.plant.engine_names import EngineName, require_compilable
from foreride.vehicle.plant.sensors import SensorNoise
from foreride.vehicle.speed_profile import SpeedProfile

MOST_INTERVALS = 400
"""Most intervals of a plan; its work grows with their cube."""
LONGEST_S = 7200
"""Longest drive: its signals, one sample per millisecond, still fit into memory."""


@dataclass(frozen=True)
class Vehicle:
    """Car of a scenario: `model` names the origin of its parameters, `parameters` holds all of them.

    fmu: file of a car from another tool (FMI co-simulation) that is driven in place of the plant; controllers
    know it by `parameters`. map: its variable for each quantity of the loop that it calls by another name.
    """

    model: str
    parameters: Car
    fmu: str | None = None
    map: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class CameraSetup(Checked):
    """Camera of a scenario: mounting, rate, latency and calibration errors.

    The camera is `behind_front_axle_m` behind the front axle. The actual mounting differs from the one
    assumed by the estimator by errors with the two sigmas, drawn from the run's seed. `stereo_base_m` adds a
    second, identical camera at this distance to its right; 0 for none. The residual relative yaw of the pair
    is drawn with `stereo_yaw_sigma_deg`.
    """

    intrinsics: Camera = field(default_factory=Camera)
    behind_front_axle_m: Annotated[float, Interval(ge=-1.0, le=5.0), "m"] = 1.6
    height_m: Annotated[float, Interval(ge=0.3, le=4.0), "m"] = 1.3
    pitch_deg: Annotated[float, Interval(ge=-10.0, le=30.0), "degrees"] = 6.0
    pitch_sigma_deg: Annotated[float, Interval(ge=0.0, le=2.0), "degrees"] = 0.2
    height_sigma_m: Annotated[float, Interval(ge=0.0, le=0.2), "m"] = 0.01
    stereo_base_m: Annotated[float, Interval(ge=0.0, le=1.0), "m"] = 0.0
    stereo_yaw_sigma_deg: Annotated[float, Interval(ge=0.0, le=0.2), "degrees"] = 0.005
    rate_hz: Annotated[int, Interval(ge=1, le=200), "Hz"] = 20
    latency_s: Annotated[float, Interval(ge=0.0, le=1.0), "s"] = 0.05

    def mount(self, front_axle_m: float) -> CameraMount:
        """Nominal camera mounting relative to the centre of gravity of a car with this front axle."""
        return CameraMount(
            x_m=front_axle_m - self.behind_front_axle_m, height_m=self.height_m, pitch_deg=self.pitch_deg
        )


@dataclass(frozen=True)
class Detection(Checked):
    """Detector settings: its confidence threshold and, unless the shipped ones, its weights.

    backend: one of `detector.backends`, or `fastest` for the fastest one on this machine; results differ
    between backends. threads: of the renderer, and of the detector. above_horizon_deg: rows farther above the
    horizon are neither rendered nor looked at; 90 for the whole image.
    """

    weights: str | None = None
    confidence: Annotated[float, Interval(ge=0.01, le=0.99), "1"] = 0.2
    threads: Annotated[int, Interval(ge=1, le=64), "threads"] = 2
    backend: Literal["cpu", "openvino", "openvino-bf16", "cuda", "tensorrt", "fastest"] = "cpu"
    above_horizon_deg: Annotated[float, Interval(ge=0.0, le=90.0), "degrees"] = 1.5


@dataclass(frozen=True)
class MapSetup(Checked):
    """Road map for the perception `map`.

    file: .csv or .crg (see `preview.prior_drives.road_map`), found beside the scenario's.
    localisation_sigma_m: standard deviation of the car's position on the map, m; the error is drawn once per
    drive.
    """

    file: str
    localisation_sigma_m: Annotated[float, Interval(ge=0.0, le=5.0), "m"] = 0.05


@dataclass(frozen=True)
class ElevationSetup(Checked):
    """Range sensor and map of the perception `elevation`.

    sensor: one of the presets by its `kind`, any parameter of which can be set. map: of the elevation map.
    """

    sensor: Sensor = field(default_factory=LidarSolidState)
    map: ElevationSettings = field(default_factory=ElevationSettings)


@dataclass(frozen=True)
class Control(Checked):
    """Sampling rate and delay of the controller, speed of the valves, and the controllers' settings.

    full_stroke_s: time in which a valve moves from one end of its range to the other, 0 for no limit.
    """

    rate_hz: Annotated[int, Interval(ge=10, le=1000), "Hz"] = 200
    delay_s: Annotated[float, Interval(ge=0.0, le=0.2), "s"] = 0.0
    full_stroke_s: Annotated[float, Interval(ge=0.0, le=1.0), "s"] = 0.0
    settings: ControllerSettings = field(default_factory=ControllerSettings)

    def __post_init__(self) -> None:
        super().__post_init__()
        mpc = self.settings.mpc
        for name in ("horizon_s", "blind_horizon_s"):
            grid = graded_grid(getattr(mpc, name), mpc.fine_s, 1.0 / self.rate_hz)
            if len(grid.intervals_s) > MOST_INTERVALS:
                raise InputError(
                    f"settings.mpc.{name} must give at most {MOST_INTERVALS} intervals, got "
                    f"{len(grid.intervals_s)} by {getattr(mpc, name):g} s at {self.rate_hz} Hz with fine_s = "
                    f"{mpc.fine_s:g}"
                )

    @property
    def timing(self) -> Timing:
        """Timing as the controllers know it."""
        return Timing(1.0 / self.rate_hz, self.delay_s, self.full_stroke_s)


@dataclass(frozen=True)
class Scenario(Checked):
    """Scenario of one drive: road, car, speed, sensors, camera and control; distances in m, speed in km/h.

    The car starts at `speed_kmh` and passes through the points of `speed`, if any, with constant acceleration
    between them. `speed_planner`: with one it cruises at `speed_kmh` and slows down for the road. Its centre
    of gravity starts at `start_m`; the run ends when the front axle reaches the road's end.
    Controllers know the car as `vehicle`; the simulated one differs from it by `plant`. `engine` integrates
    it: MuJoCo, or the compiled equations, which agree to rounding and are faster. `enveloping` is the tyre
    model for obstacles shorter than the tyre. `told` lists the quantities of detected objects that are
    replaced by the truth, to measure the cost of errors. `memory` is the
    memory.yaml that an earlier drive over the same road left in its run folder. `tyre_load_weight` is rho in
    the objective J = wk_rms² + rho · tyre_load_rms², (m/s²)².
    """

    name: str
    title: str
    speed_kmh: Annotated[float, Interval(ge=1.0, le=200.0), "km/h"]
    road: Road
    vehicle: Vehicle
    start_m: Annotated[float, Interval(ge=0.0, le=100_000.0), "m"] = 2.0
    speed: tuple[SpeedPoint, ...] = ()
    speed_planner: SpeedPlanner | None = None
    plant: PlantDifference = field(default_factory=PlantDifference)
    engine: EngineName = "mujoco"
    enveloping: Enveloping = field(default_factory=RigidWheel)
    observer: Literal["truth", "sensors"] = "sensors"
    sensors: SensorNoise = field(default_factory=SensorNoise)
    camera: CameraSetup = field(default_factory=CameraSetup)
    detection: Detection = field(default_factory=Detection)
    boxes: BoxErrors = field(default_factory=BoxErrors)
    oracle: OracleErrors = field(default_factory=OracleErrors)
    faults: tuple[Fault, ...] = ()
    estimator: EstimatorSettings = field(default_factory=EstimatorSettings)
    told: tuple[Literal["distance", "shape"], ...] = ()
    memory: str | None = None
    map: MapSetup | None = None
    elevation: ElevationSetup = field(default_factory=ElevationSetup)
    appearance: Appearance = field(default_factory=Appearance)
    control: Control = field(default_factory=Control)
    tyre_load_weight: Annotated[float, Interval(ge=0.0, le=1000.0), "(m/s²)²"] = 3.0
    seed: Seed = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_name("name", self.name)
        if self.speed and self.speed_planner:
            raise InputError("speed_planner must be left out where speed gives the speed over the drive")
        try:
            assert self.true_car
        except InputError as error:
            raise InputError(f"plant must leave the car plausible: {error}") from None
        if self.vehicle.fmu and self.true_car != self.vehicle.parameters:
            raise InputError("plant must leave the car as it is, as vehicle.fmu is the car")
        if self.engine == "compiled":
            if self.vehicle.fmu:
                raise InputError("engine must be left out, as vehicle.fmu is the car")
            require_compilable(self.true_car)
        require_applicable(self.vehicle.parameters, self.faults, self.sensors, self.control.settings)
        front_axle_m = max(self.vehicle.parameters.axle_x_m)
        start_limit_m = self.road.length_m - front_axle_m - 1.0
        if start_limit_m <= 0.0:
            raise InputError(
                f"road.length_m must be > {front_axle_m + 1.0:g} m, 1 m more than from the centre of gravity "
                f"to the front axle, got {self.road.length_m:g}"
            )
        if not self.start_m < start_limit_m:
            raise InputError(
                f"start_m must lie in 0 ... {start_limit_m:g} m (the road's end), got {self.start_m:g}"
            )
        if self.ticks > LONGEST_S * TICKS_PER_SECOND:
            raise InputError(
                f"road.length_m, speed_kmh and speed must give a drive of at most {LONGEST_S} s, "
                f"got {self.ticks / TICKS_PER_SECOND:.0f} s"
            )

    @property
    def speed_m_s(self) -> float:
        """Initial forward speed."""
        return self.speed_kmh * KM_H

    @cached_property
    def true_car(self) -> Car:
        """The simulated car."""
        return self.plant.applied(self.vehicle.parameters)

    @cached_property
    def motion(self) -> float | SpeedProfile:
        """Forward motion over the drive: a constant speed, m/s, or a speed profile."""
        return profile(self.speed_kmh, self.start_m, self.speed) if self.speed else self.speed_m_s

    def require_given_speed(self, what: str) -> None:
        """Raise InputError if the speed is planned during the drive, for a use that must know it before."""
        if self.speed_planner:
            raise InputError(f"speed_planner must be left out for {what}, which needs the speed beforehand")

    @property
    def end_m(self) -> float:
        """Position of the centre of gravity at which the front axle reaches the road's end."""
        return self.road.length_m - max(self.vehicle.parameters.axle_x_m)

    @property
    def preview_m(self) -> float:
        """Length of the road ahead that perceptions preview."""
        planner = self.speed_planner
        return max(PREVIEW_M, planner.sight_m) if isinstance(planner, PreviewPlanner) else PREVIEW_M

    @property
    def ticks(self) -> int:
        """Length of the run in plant ticks; with a speed planner, of one at the cruising speed."""
        end = self.end_m
        if isinstance(self.motion, SpeedProfile):
            return int(self.motion.time_at(end) * TICKS_PER_SECOND)
        distance = end - self.start_m
        return int(distance / self.speed_m_s * TICKS_PER_SECOND)

    @cached_property
    def mapping(self) -> dict[str, Any]:
        """All fields as plain values, defaults included: the input of the scenario hash."""
        mapping = strict.to_mapping(self)
        assert isinstance(mapping, dict)
        return mapping
