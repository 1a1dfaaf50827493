"""Settings of the estimator: sensor error model, object priors and thresholds."""

from dataclasses import dataclass, fields
from typing import Literal, get_args

from files.errors import InputError
from preview.edge_bias import BOTTOM_BIAS_PX, TOP_BIAS_PX
from road.checks import check_choice

Distance = Literal["fit", "cross_ratio"]


@dataclass(frozen=True)
class Settings:
    """Parameters of the estimator; the defaults suit a detector accurate to about one pixel.

    Every `..._sigma...` is one standard deviation. A value that is not above zero (the biases may have any
    sign), a probability outside 0..1 or an unknown ranging method (`distance`) raises `InputError`.
    """

    # Boxes
    pixel_sigma: float = 0.8
    relative_sigma: float = 0.02  # additional, relative to the box height: errors of large boxes are greater
    correlation: float = 2.0  # variance inflation: errors of successive boxes are correlated
    # Systematic box edge minus true edge of bumps and of potholes, rows counted downwards
    bottom_bias_px: tuple[float, float] = BOTTOM_BIAS_PX
    top_bias_px: tuple[float, float] = TOP_BIAS_PX
    # Prior sigma of bottom_bias_px, beyond errors that shift the boxes of all classes alike
    edge_sigma_px: tuple[float, float] = (0.3, 0.5)
    border_px: float = 2.0  # edges this close to the image border or bonnet count as cut
    bonnet_row_px: float = 1e9  # first image row hidden by the bonnet
    max_boxes: int = 48  # newest boxes kept per track

    # Geometry (priors of the fit)
    # Ranging method: fit of all boxes, or `preview.cross_ratio` of the last one
    distance: Distance = "fit"
    pitch_sigma_deg: float = 0.04  # noise of the ego pitch at exposure
    offset_sigma_deg: float = 0.24  # prior of the mounting pitch
    offset_track_sigma_deg: float = 0.08  # road grade and box bias, independent for each object
    camera_height_sigma_m: float = 0.01  # prior of the mounting height
    edge_height_sigma_m: float = 0.008  # ground at the object over the road plane, independent for each
    odometry_sigma: float = 0.005  # relative error of travelled distance

    # Existence
    detection_probability: float = 0.8
    false_repeat_probability: float = 0.1  # of a false box on an existing track
    confusion_probability: float = 0.1  # of a wrong class
    bump_real_probability: float = 0.99  # that a repeatedly detected bump is real
    pothole_real_probability: float = 0.97  # of a pothole: stains and patches look like holes
    score_evidence: bool = True  # use scores as evidence of realness; calibrated for the shipped weights
    birth_range_m: float = 35.0
    confirm_existence: float = 0.8
    death_existence: float = 0.05

    # Ego motion
    heave_sigma_m: float = 0.01  # initial, of the body
    body_pitch_sigma_deg: float = 0.5
    gyro_offset_sigma_deg_s: float = 0.1
    gyro_noise_deg_s: float = 0.01  # per √Hz
    accelerometer_offset_sigma_m_s2: float = 0.03
    accelerometer_noise_m_s2: float = 0.003  # per √Hz
    level_ratio: float = 40.0  # sigma of one road-height reading, over the road's rise in 0.1 s
    least_roughness_m: float = 0.0005
    roughness_memory_s: float = 1.0
    # Threshold of a change of grade: mean height of the wheels over the plane, in rises, and at least in m
    grade_rises: float = 6.0
    grade_rise_m: float = 0.02
    strike_acc_m_s2: float = 25.0  # wheel acceleration above which the rattle-space reference is ignored
    strike_hold_s: float = 0.15
    history_s: float = 3.0

    # Hit feedback
    hit_sigma_m: float = 0.03
    hit_gate_m: float = 0.5
    wheel_hop_hz: float = 10.8  # wheel on its tyre only
    body_hop_hz: float = 3.5  # body on the tyres only

    # Heights measured in images
    parallax: bool = False  # measure with one moving camera; a stereo pair is always used
    gauge_near_m: float = 2.8  # least distance from the camera of a height measurement
    gauge_far_m: float = 9.0
    stereo_shift_sigma_m: float = 0.03  # common shift of positions by a stereo pair
    parallax_shift_sigma_m: float = 0.15  # the same for positions that rest on the plane alone

    # Preview
    background_sigma_m: float = 0.01  # road height without a detected object

    def precision(self, cls: int) -> float:
        """Probability that a repeatedly detected object of class `cls` is real."""
        return (self.bump_real_probability, self.pothole_real_probability)[cls]

    def __post_init__(self) -> None:
        check_choice("distance", self.distance, get_args(Distance))
        for field in fields(self):
            value = getattr(self, field.name)
            if "bias" in field.name or isinstance(value, bool | str):
                continue
            if not (min(value) if isinstance(value, tuple) else value) > 0:
                raise InputError(f"{field.name} must be > 0, got {value}")
            if ("probability" in field.name or "existence" in field.name) and value >= 1:
                raise InputError(f"{field.name} must be < 1, got {value}")
