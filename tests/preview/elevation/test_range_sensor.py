"""Tests of the range sensors: fields of view, errors by the data sheet, and what is refused."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.preview.elevation.range_sensor import PRESETS, Lidar64, LidarSolidState, RangeSensor, Stereo30cm


@pytest.mark.parametrize("preset", PRESETS)
def test_directions_are_unit_vectors_of_the_field_of_view(preset: type[RangeSensor]) -> None:
    sensor = preset()
    assert len(sensor.directions) == len(sensor.azimuths_rad) * len(sensor.elevations_rad)
    assert np.linalg.norm(sensor.directions, axis=1) == pytest.approx(1.0)
    assert np.degrees(np.arcsin(sensor.directions[:, 2])).min() == pytest.approx(
        np.degrees(sensor.elevations_rad.min())
    )


def test_the_spinning_lidar_has_sixty_four_beams_over_its_field() -> None:
    degrees = np.degrees(Lidar64().elevations_rad)
    assert len(degrees) == 64
    assert degrees[[0, -1]] == pytest.approx([-24.9, 2.0], abs=0.1)


def test_the_solid_state_lidar_gives_the_points_of_its_data_sheet() -> None:
    sensor = LidarSolidState()
    per_degree = len(sensor.directions) / (2 * sensor.azimuth_deg)
    assert 120.0 * per_degree * sensor.rate_hz == pytest.approx(452_000, rel=0.05)


def test_the_error_of_stereo_grows_with_the_square_of_depth() -> None:
    sensor = Stereo30cm()
    near, far = sensor.range_sigma_m(np.array([5.0, 10.0]))
    assert far == pytest.approx(4.0 * near)
    assert far == pytest.approx(10.0**2 * 0.2 / (1373.0 * 0.3))
    assert Stereo30cm(base_m=0.6).range_sigma_m(np.array([10.0]))[0] == pytest.approx(0.5 * far)


@pytest.mark.parametrize(
    ("build", "told"),
    [
        (lambda: Lidar64(min_range_m=60.0), r"max_range_m must be > min_range_m = 60 m, got 50"),
        (
            lambda: Lidar64(azimuth_step_deg=0.01, elevation_step_deg=0.01),
            r"must give 1 ... 200000 directions",
        ),
        (lambda: Lidar64(elevation_min_deg=5.0), r"must give 1 ... 200000 directions"),
        (lambda: Lidar64(range_noise_m=2.0), r"range_noise_m must lie in 0 ... 1 m"),
        (lambda: Stereo30cm(width_px=64, window_columns_px=65), r"must give 1 ... 200000 directions"),
    ],
)
def test_what_is_no_sensor_is_refused(build: object, told: str) -> None:
    with pytest.raises(InputError, match=told):
        build()  # type: ignore[operator]
