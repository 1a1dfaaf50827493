from dataclasses import replace

import numpy as np
import pytest

from foreride.detector.calibration import DEFAULT_CALIBRATION
from foreride.files.errors import InputError
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


@pytest.mark.parametrize("field", ["top_bias_px", "bottom_bias_px", "edge_sigma_px", "real_probability"])
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
