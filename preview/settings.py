"""Settings of the estimator: sensor error model, object priors and thresholds."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Literal, get_args

from annotated_types import Interval

from foreride.detector.calibration import DEFAULT_CALIBRATION, Bias, Calibration, Probability
from foreride.files.errors import InputError
from foreride.files.reading.checks import check_choice
from foreride.files.reading.ranges import Checked
from foreride.preview.obstacle_classes import (
    CONFIRM_EXISTENCE,
    EDGE_SIGMA_PX,
    NEAR_CONFIRM_EXISTENCE,
    REAL_PROBABILITY,
)
from foreride.road.obstacle_classes import check_per_class

Angle = Annotated[float, Interval(ge=1e-3, le=30.0), "degrees"]
EdgeSigma = Annotated[float, Interval(ge=1e-3, le=100.0), "px"]
HeightSigma = Annotated[float, Interval(ge=1e-5, le=1.0), "m"]
Distance = Literal["fit", "cross_ratio"]


@dataclass(frozen=True)
class Settings(Checked):
    """Parameters of the estimator; the defaults suit a detector accurate to about one pixel.

    Every `..._sigma...` is one standard deviation. A value out of range or an unknown ranging method
    (`distance`) raises `InputError`.
    """

    # Boxes
    pixel_sigma: Annotated[float, Interval(ge=0.01, le=100.0), "px"] = 0.8
    # Additional, relative to the box height: errors of large boxes are greater
    relative_sigma: Annotated[float, Interval(ge=1e-4, le=1.0), "1"] = 0.02
    # Variance inflation: errors of successive boxes are correlated
    correlation: Annotated[float, Interval(ge=0.01, le=1000.0), "1"] = 2.0
    # Systematic box edge minus true edge of each class, rows counted downwards; None: as calibrated with the
    # weights of the detector
    bottom_bias_px: tuple[Bias, ...] | None = None
    top_bias_px: tuple[Bias, ...] | None = None
    # Prior sigma of bottom_bias_px, beyond errors that shift the boxes of all classes alike
    edge_sigma_px: tuple[EdgeSigma, ...] = EDGE_SIGMA_PX
    # Edges this close to the image border or bonnet count as cut
    border_px: Annotated[float, Interval(ge=0.01, le=1000.0), "px"] = 2.0
    # First image row hidden by the bonnet
    bonnet_row_px: Annotated[float, Interval(ge=1.0, le=8192.0), "px"] = 8192.0
    max_boxes: Annotated[int, Interval(ge=1, le=1000), "boxes"] = 48  # newest boxes kept per track

    # Geometry (priors of the fit)
    # Ranging method: fit of all boxes, or `preview.geometry.cross_ratio` of the last one
    distance: Distance = "fit"
    pitch_sigma_deg: Angle = 0.04  # noise of the ego pitch at exposure
    offset_sigma_deg: Angle = 0.24  # prior of the mounting pitch
    offset_track_sigma_deg: Angle = 0.08  # road grade and box bias, independent for each object
    camera_height_sigma_m: HeightSigma = 0.01  # prior of the mounting height
    edge_height_sigma_m: HeightSigma = 0.008  # ground at the object over the road plane, independent for each
    # Relative error of travelled distance
    odometry_sigma: Annotated[float, Interval(ge=1e-6, le=0.5), "1"] = 0.005

    # Existence
    detection_probability: Probability = 0.8
    false_repeat_probability: Probability = 0.1  # of a false box on an existing track
    confusion_probability: Probability = 0.1  # of a wrong class
    real_probability: tuple[Probability, ...] = REAL_PROBABILITY  # of a repeatedly detected object, by class
    score_evidence: bool = True  # use scores as evidence of realness, as calibrated with the weights
    birth_range_m: Annotated[float, Interval(ge=1.0, le=500.0), "m"] = 35.0
    # Existence above which a track is confirmed, by class; the second within near_confirm_m
    confirm_existence: tuple[Probability, ...] = CONFIRM_EXISTENCE
    near_confirm_existence: tuple[Probability, ...] = NEAR_CONFIRM_EXISTENCE
    near_confirm_m: Annotated[float, Interval(ge=0.0, le=500.0), "m"] = 6.0
    death_existence: Probability = 0.05

    # Ego motion
    heave_sigma_m: HeightSigma = 0.01  # initial, of the body
    body_pitch_sigma_deg: Angle = 0.5
    gyro_offset_sigma_deg_s: Annotated[float, Interval(ge=1e-6, le=10.0), "degrees/s"] = 0.1
    gyro_noise_deg_s: Annotated[float, Interval(ge=1e-6, le=10.0), "degrees/s"] = 0.01  # per √Hz
    accelerometer_offset_sigma_m_s2: Annotated[float, Interval(ge=1e-6, le=10.0), "m/s²"] = 0.03
    accelerometer_noise_m_s2: Annotated[float, Interval(ge=1e-6, le=10.0), "m/s²"] = 0.003  # per √Hz
    # Sigma of one road-height reading, over the road's rise in 0.1 s
    level_ratio: Annotated[float, Interval(ge=0.01, le=1e4), "1"] = 40.0
    least_roughness_m: Annotated[float, Interval(ge=1e-6, le=0.1), "m"] = 0.0005
    roughness_memory_s: Annotated[float, Interval(ge=0.01, le=100.0), "s"] = 1.0
    # Threshold of a change of grade: mean height of the wheels over the plane, in rises, and at least in m
    grade_rises: Annotated[float, Interval(ge=0.1, le=1000.0), "1"] = 6.0
    grade_rise_m: Annotated[float, Interval(ge=1e-4, le=1.0), "m"] = 0.02
    # Wheel acceleration above which the rattle-space reference is ignored
    strike_acc_m_s2: Annotated[float, Interval(ge=0.1, le=1e4), "m/s²"] = 25.0
    strike_hold_s: Annotated[float, Interval(ge=1e-3, le=10.0), "s"] = 0.15
    history_s: Annotated[float, Interval(ge=0.1, le=60.0), "s"] = 3.0

    # Hit feedback
    hit_sigma_m: Annotated[float, Interval(ge=1e-4, le=10.0), "m"] = 0.03
    hit_gate_m: Annotated[float, Interval(ge=1e-3, le=10.0), "m"] = 0.5

    # Heights measured in images
    parallax: bool = False  # measure with one moving camera; a stereo pair is always used
    # Least distance from the camera of a height measurement
    gauge_near_m: Annotated[float, Interval(ge=0.1, le=100.0), "m"] = 2.8
    gauge_far_m: Annotated[float, Interval(ge=0.2, le=100.0), "m"] = 9.0
    # Common shift of positions by a stereo pair
    stereo_shift_sigma_m: Annotated[float, Interval(ge=1e-4, le=10.0), "m"] = 0.03
    # The same for positions that rest on the plane alone
    parallax_shift_sigma_m: Annotated[float, Interval(ge=1e-4, le=10.0), "m"] = 0.15

    # Preview
    # Road height without a detected object
    background_sigma_m: Annotated[float, Interval(ge=1e-5, le=1.0), "m"] = 0.01

    def calibrated(self, calibration: Calibration) -> "Settings":
        """Settings with the edge biases of a calibrated detector where they have none of their own."""
        top_px = self.top_bias_px or tuple(one.top_bias_px for one in calibration)
        bottom_px = self.bottom_bias_px or tuple(one.bottom_bias_px for one in calibration)
        return replace(self, top_bias_px=top_px, bottom_bias_px=bottom_px)

    @cached_property
    def edge_bias_px(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Edge bias of each class, top and bottom; that of the shipped weights where none is set."""
        known = self.calibrated(DEFAULT_CALIBRATION)
        assert known.top_bias_px is not None
        assert known.bottom_bias_px is not None
        return known.top_bias_px, known.bottom_bias_px

    def __post_init__(self) -> None:
        check_choice("distance", self.distance, get_args(Distance))
        super().__post_init__()
        check_per_class(self, "top_bias_px", "bottom_bias_px", "edge_sigma_px", "real_probability")
        check_per_class(self, "confirm_existence", "near_confirm_existence")
        if not self.gauge_near_m < self.gauge_far_m:
            raise InputError(
                f"gauge_near_m must be < gauge_far_m ({self.gauge_far_m:g} m), got {self.gauge_near_m:g}"
            )
