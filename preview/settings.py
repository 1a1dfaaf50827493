"""Every number that the estimator believes about its sensors and the objects it looks for."""

from dataclasses import dataclass, fields
from typing import Literal, get_args

from files.errors import InputError
from preview.edge_bias import BOTTOM_BIAS_PX, TOP_BIAS_PX
from road.checks import check_choice

Distance = Literal["fit", "cross_ratio"]


@dataclass(frozen=True)
class Settings:
    """Beliefs of the estimator; the defaults suit a detector good to about one pixel.

    Every `..._sigma...` is one standard deviation. A value that is not above zero (the biases may have
    any sign), a probability outside 0..1 or an unknown way to the distance raises `InputError`.
    """

    # Boxes
    pixel_sigma: float = 0.8
    relative_sigma: float = 0.02  # of the box height, on top: large boxes err by more pixels than small ones
    correlation: float = 2.0  # variance inflation, because errors of successive boxes resemble each other
    # Systematic box edge minus true edge of bumps and of potholes, rows counted downwards
    bottom_bias_px: tuple[float, float] = BOTTOM_BIAS_PX
    top_bias_px: tuple[float, float] = TOP_BIAS_PX
    # How little is known of the former, beside what moves the boxes of all classes alike
    edge_sigma_px: tuple[float, float] = (0.3, 0.5)
    border_px: float = 2.0  # edges this near to the image border or bonnet are cut, not seen
    bonnet_row_px: float = 1e9  # first image row that the bonnet hides
    max_boxes: int = 48  # of one track, the newest are kept

    # Geometry (section priors of the fit)
    # How far an object is: the fit of all its boxes, or `preview.cross_ratio` of the last one
    distance: Distance = "fit"
    pitch_sigma_deg: float = 0.04  # noise of the ego pitch at exposure
    offset_sigma_deg: float = 0.24  # mounting pitch, before anything was learned
    offset_track_sigma_deg: float = 0.08  # road grade and box bias, new with each object
    camera_height_sigma_m: float = 0.01  # mounting height, before anything was learned
    edge_height_sigma_m: float = 0.008  # ground at the object over the local road plane, new with each
    odometry_sigma: float = 0.005  # relative error of travelled distance

    # Existence
    detection_probability: float = 0.8
    false_repeat_probability: float = 0.1  # that a false box meets a track again
    confusion_probability: float = 0.1  # that a box names the wrong class
    bump_real_probability: float = 0.99  # of what is seen again and again as a bump
    pothole_real_probability: float = 0.97  # stains and patches look like holes in every frame
    score_evidence: bool = True  # scores tell what is real, as those of the shipped weights do
    birth_range_m: float = 35.0
    confirm_existence: float = 0.8
    death_existence: float = 0.05

    # Ego motion
    heave_sigma_m: float = 0.01  # of the body at the start
    body_pitch_sigma_deg: float = 0.5
    gyro_offset_sigma_deg_s: float = 0.1
    gyro_noise_deg_s: float = 0.01  # per √Hz
    accelerometer_offset_sigma_m_s2: float = 0.03
    accelerometer_noise_m_s2: float = 0.003  # per √Hz
    level_ratio: float = 40.0  # sigma of one reading's road height, over the road's rise in 0.1 s
    least_roughness_m: float = 0.0005
    roughness_memory_s: float = 1.0
    # Mean height of the wheels over the road plane that tells of another grade: in rises, and at least
    grade_rises: float = 6.0
    grade_rise_m: float = 0.02
    strike_acc_m_s2: float = 25.0  # wheel acceleration that makes the rattle reference useless
    strike_hold_s: float = 0.15
    history_s: float = 3.0

    # Hit feedback
    hit_sigma_m: float = 0.03
    hit_gate_m: float = 0.5
    wheel_hop_hz: float = 10.8  # wheel on its tyre alone
    body_hop_hz: float = 3.5  # body on the tyre alone

    # Heights measured in images
    parallax: bool = False  # of one moving camera; a stereo pair is always used
    gauge_near_m: float = 2.8  # from the camera: nearer than this nothing is measured
    gauge_far_m: float = 9.0
    stereo_shift_sigma_m: float = 0.03  # of all positions that a stereo pair gives
    parallax_shift_sigma_m: float = 0.15  # of those that rest on the plane alone

    # Preview
    background_sigma_m: float = 0.01  # road height where nothing was seen

    def precision(self, cls: int) -> float:
        """How often what is seen again and again as class `cls` is real."""
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
