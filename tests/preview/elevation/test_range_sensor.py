"""Tests of the range sensors: fields of view, errors by the data sheet, and what is refused."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.preview.elevation.range_sensor import (
    PRESETS,
    Lidar64,
    LidarSolidState,
    RangeSensor,
    Sensor,
    Stereo30cm,
)


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


COMMON = {
    "height_m": 1.3, "behind_front_axle_m": 1.6, "pitch_deg": 0.0, "rate_hz": 10, "latency_s": 0.05,
    "dropout": 0.02, "bias_sigma_m": 0.0, "pitch_sigma_deg": 0.1, "roll_sigma_deg": 0.1, "min_range_m": 0.5,
    "max_range_m": 100.0,
}  # fmt: skip
LIDAR = {"azimuth_deg": 25.0, "range_noise_m": 0.02, "elevation_max_deg": 0.0, "pulse_m": 0.5}
PRESET_VALUES = {
    Lidar64: COMMON | LIDAR | {
        "height_m": 1.73, "azimuth_step_deg": 0.1728, "elevation_min_deg": -24.9, "elevation_max_deg": 2.0,
        "elevation_step_deg": 0.4269, "angle_sigma_deg": 0.02, "beam_deg": 0.115, "min_range_m": 0.9,
        "max_range_m": 50.0,
    },
    LidarSolidState: COMMON | LIDAR | {
        "height_m": 1.4, "pitch_deg": 10.0, "azimuth_step_deg": 0.2, "elevation_min_deg": -12.5,
        "elevation_max_deg": 12.5, "elevation_step_deg": 0.33, "angle_sigma_deg": 0.1, "beam_deg": 0.28,
        "max_range_m": 150.0,
    },
    Stereo30cm: COMMON | {
        "pitch_deg": 6.0, "rate_hz": 20, "min_range_m": 2.0, "base_m": 0.3, "focal_px": 1373.0,
        "disparity_sigma_px": 0.2, "width_px": 1280, "height_px": 960, "window_columns_px": 9,
        "window_rows_px": 3,
    },
}  # fmt: skip


@pytest.mark.parametrize("preset", PRESETS)
def test_presets_are_those_of_their_data_sheets(preset: type[Sensor]) -> None:
    assert strict.to_mapping(preset()) == PRESET_VALUES[preset] | {"kind": preset.kind}


def test_beams_average_over_their_divergence_and_echoes_merge_within_a_pulse() -> None:
    sensor = Lidar64()
    assert sensor.footprint_rad == pytest.approx(np.deg2rad(0.115))
    assert sensor.direction_sigma_rad == pytest.approx(np.deg2rad(0.02))
    assert sensor.separation == (0.5, 0.0)
    np.testing.assert_array_equal(sensor.range_sigma_m(np.array([3.0, 30.0])), [0.02, 0.02])
    assert np.degrees(sensor.azimuths_rad[[0, -1]]) == pytest.approx([-25.0, 25.0], abs=0.17)
    assert np.degrees(np.diff(sensor.azimuths_rad)) == pytest.approx(0.1728)


def test_windows_of_stereo_lie_side_by_side_about_the_middle_and_see_the_road() -> None:
    sensor = Stereo30cm()
    columns, rows = 1373.0 * np.tan(sensor.azimuths_rad), 1373.0 * np.tan(sensor.elevations_rad)
    assert len(columns) == 142
    assert columns.sum() == pytest.approx(0.0, abs=1e-6)
    assert np.diff(columns) == pytest.approx(9.0)
    assert np.diff(rows) == pytest.approx(3.0)
    assert rows[0] == pytest.approx(-1.5 * 319)
    assert sensor.elevations_rad.max() < np.deg2rad(6.0) - 0.03 <= sensor.elevations_rad.max() + 3.1 / 1373.0
    assert sensor.footprint_rad == pytest.approx(3.0 / 1373.0)
    assert sensor.separation == (0.0, pytest.approx(1.0 / (1373.0 * 0.3)))
    assert sensor.direction_sigma_rad == 0.0


def test_directions_point_forward_left_and_up() -> None:
    sensor = LidarSolidState()
    pairs = [(a, e) for a in sensor.azimuths_rad for e in sensor.elevations_rad]
    for place in (0, 77, 5000, len(pairs) - 1):
        azimuth, elevation = pairs[place]
        expected = np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)
        assert sensor.directions[place] == pytest.approx(expected)
    mount = sensor.mount(1.25)
    assert (mount.x_m, mount.height_m, mount.pitch_deg) == (pytest.approx(1.25 - 1.6), 1.4, 10.0)


def test_the_number_of_directions_is_limited_to_200000() -> None:
    with pytest.raises(InputError, match="200000 directions, got"):
        Lidar64(azimuth_step_deg=0.1, elevation_step_deg=0.0626)
    fits = Lidar64(azimuth_step_deg=0.1, elevation_step_deg=0.0691)
    assert 190_000 < len(fits.directions) <= 200_000
