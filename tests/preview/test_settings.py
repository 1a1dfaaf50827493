from dataclasses import replace

import numpy as np
import pytest

from foreride.detector.calibration import DEFAULT_CALIBRATION
from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.preview.elevation.settings import ElevationSettings
from foreride.preview.obstacle_classes import EDGE_SIGMA_PX, KINDS, REAL_PROBABILITY, templates_of
from foreride.preview.settings import Settings
from foreride.vehicle.load import HalfCar, load_vehicle


def test_biases_may_have_any_sign():
    assert Settings(bottom_bias_px=(-1.0, 0.0)).bottom_bias_px == (-1.0, 0.0)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("pixel_sigma", 0.0),
        ("offset_sigma_deg", -1.0),
        ("detection_probability", 1.0),
        ("hit_sigma_m", 0.0),
        ("edge_sigma_px", (0.3, 0.0)),
    ],
)
def test_names_the_field_out_of_range(field, value):
    with pytest.raises(InputError, match=rf"^{field}(\[1\])? must (be|lie in) "):
        Settings(**{field: value})


def test_an_unknown_way_to_the_distance_is_refused():
    with pytest.raises(InputError, match="distance must be one of fit, cross_ratio, got 'crossratio'"):
        Settings(distance="crossratio")


def test_biases_come_from_the_detector_unless_set():
    own = tuple(replace(one, top_bias_px=1.5, bottom_bias_px=-1.5) for one in DEFAULT_CALIBRATION)
    settings = Settings(bottom_bias_px=(0.0, 0.5)).calibrated(own)
    assert settings.edge_bias_px == ((1.5, 1.5), (0.0, 0.5))
    assert Settings().edge_bias_px == Settings().calibrated(DEFAULT_CALIBRATION).edge_bias_px


@pytest.mark.parametrize(
    "field",
    [
        "top_bias_px", "bottom_bias_px", "edge_sigma_px", "real_probability", "confirm_existence",
        "near_confirm_existence",
    ],
)  # fmt: skip
def test_values_by_class_must_be_one_per_class(field):
    with pytest.raises(InputError, match=f"^{field} must hold 2 values, of speed_bump, pothole, got 1$"):
        Settings(**{field: (0.5,)})


def test_the_first_pitch_is_uncertain_by_what_a_passenger_does():
    """75 kg on the rear seat of each side turn the compact car on its springs and tyres by 0.6 degrees."""
    car = load_vehicle("half_car")
    assert isinstance(car, HalfCar)
    spring, tyre = np.array(car.spring_n_m), np.array(car.tyre_n_m)
    arm = np.array([car.front_axle_m, car.rear_axle_m])
    stiffness = (spring * tyre / (spring + tyre)) @ arm**2
    pitch = np.rad2deg(75.0 * 9.81 * -car.seat_x_m[1] / stiffness)
    assert Settings().body_pitch_sigma_deg == pytest.approx(pitch, rel=0.25)


DEFAULTS = {
    "pixel_sigma": 0.8, "relative_sigma": 0.02, "correlation": 2.0, "bottom_bias_px": None,
    "top_bias_px": None, "edge_sigma_px": [0.3, 0.5], "border_px": 2.0, "bonnet_row_px": 8192.0,
    "max_boxes": 48, "distance": "fit", "pitch_sigma_deg": 0.04, "offset_sigma_deg": 0.24,
    "offset_track_sigma_deg": 0.08, "camera_height_sigma_m": 0.01, "edge_height_sigma_m": 0.008,
    "odometry_sigma": 0.005, "detection_probability": 0.8, "false_repeat_probability": 0.1,
    "confusion_probability": 0.1, "real_probability": [0.99, 0.97], "score_evidence": True,
    "birth_range_m": 35.0, "confirm_existence": [0.96, 0.94], "near_confirm_existence": [0.88, 0.8],
    "near_confirm_m": 6.0, "death_existence": 0.05, "heave_sigma_m": 0.01,
    "body_pitch_sigma_deg": 0.5, "gyro_offset_sigma_deg_s": 0.1, "gyro_noise_deg_s": 0.01,
    "accelerometer_offset_sigma_m_s2": 0.03, "accelerometer_noise_m_s2": 0.003, "level_ratio": 40.0,
    "least_roughness_m": 0.0005, "roughness_memory_s": 1.0, "grade_rises": 6.0, "grade_rise_m": 0.02,
    "strike_acc_m_s2": 25.0, "strike_hold_s": 0.15, "history_s": 3.0, "hit_sigma_m": 0.03,
    "hit_gate_m": 0.5, "parallax": False, "gauge_near_m": 2.8, "gauge_far_m": 9.0,
    "stereo_shift_sigma_m": 0.03, "parallax_shift_sigma_m": 0.15, "background_sigma_m": 0.01,
}  # fmt: skip


def test_what_a_scenario_leaves_out_is_as_documented():
    assert strict.to_mapping(Settings()) == DEFAULTS
    assert strict.to_mapping(ElevationSettings()) == {
        "cell_m": 0.05, "column_m": 0.1, "reach_m": 12.0, "road_sigma_m": 0.02, "road_length_m": 2.0,
        "cell_sigma_m": 0.001, "heave_sigma_m": 0.005, "tilt_sigma_deg": 0.1, "tyre_width_m": 0.2,
        "odometry_sigma": 0.005,
    }  # fmt: skip


def test_templates_are_those_of_the_design_rules_that_they_name():
    """Share, length and height with their sigmas, ramp, m."""
    expected = {
        "bump": (0.3, 0.45, 0.20, 0.070, 0.020, 0.0),
        "block": (0.1, 0.60, 0.25, 0.055, 0.015, 0.2),
        "hump": (0.2, 3.7, 0.70, 0.080, 0.020, 0.0),
        "sinusoidal": (0.1, 3.7, 0.70, 0.080, 0.020, 0.0),
        "table": (0.15, 3.9, 0.90, 0.080, 0.018, 0.9),
        "long_table": (0.05, 7.0, 0.90, 0.080, 0.015, 0.9),
        "cushion": (0.1, 2.7, 0.60, 0.068, 0.010, 0.55),
        "pothole": (1.0, 0.60, 0.30, 0.070, 0.025, 0.0),
    }
    found = {
        kind.name: (
            kind.share, kind.length_m, kind.length_sigma_m, kind.height_m, kind.height_sigma_m, kind.ramp_m,
        )
        for kind in KINDS
    }  # fmt: skip
    assert found == expected
    assert (EDGE_SIGMA_PX, REAL_PROBABILITY) == ((0.3, 0.5), (0.99, 0.97))
    for cls in (0, 1):
        assert sum(kind.share for kind in templates_of(cls)) == pytest.approx(1.0)


def test_a_height_is_measured_over_some_range_at_least():
    with pytest.raises(InputError, match=r"gauge_near_m must be < gauge_far_m \(5 m\), got 5"):
        Settings(gauge_near_m=5.0, gauge_far_m=5.0)
