"""What one drive leaves for the next: files, and a second drive that starts better informed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from files.errors import InputError
from preview.calibration import Calibration
from preview.memory import Memory, Mounting, Remembered, Rows, expectations, read, recall, remember, write
from preview.perception import BoxErrors
from preview.settings import Settings
from preview.tracker import Tracker
from road.features import HalfSineBump, Pothole
from road.profile import Road
from tests.preview.kinematic_drive import Drive, drive

BUMP = Remembered("bump", 60.0, 0.03, 0.5, 0.05, 0.08, 0.01, -3.0, 3.0, 0.1, 0.95)
HOLE = Remembered("pothole", 90.0, 0.05, 0.6, 0.1, 0.07, 0.02, -1.0, -0.4, 0.05, 0.9)
ROWS = Rows((-0.2, 0.9), (0.04, 0.09), 0.01, (1e-5, 2e-5), (1e-5, -3e-5))
MEMORY = Memory(Mounting(0.003, -0.01, 1e-6, 1e-7, 1e-4), (BUMP, HOLE), ROWS)
FOCAL_PX = 457.0

sizes = st.floats(0.01, 5.0)


@given(st.floats(-1e3, 1e3), sizes, sizes, sizes, st.floats(0.01, 0.99))
def test_a_file_gives_back_what_was_written(tmp_path_factory, x, sigma, length, height, existence):
    place = Remembered("hump", x, sigma, length, sigma, height, sigma, -1.0, 1.0, sigma, existence)
    path = tmp_path_factory.mktemp("memory") / "memory.yaml"
    write(path, Memory(MEMORY.mounting, (place,), ROWS))
    assert read(path) == Memory(MEMORY.mounting, (place,), ROWS)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ("kind: bumb", "kind must be one of"),
        ("existence: 1.0", "existence must lie"),
        ("x_sigma_m: 0.0", "x_sigma_m must be > 0"),
        ("y_min_m: 4.0", "y_min_m must be <= y_max_m"),
        ("hight_m: 1.0", "hight_m"),
    ],
)
def test_a_bad_file_is_refused_by_name_and_field(tmp_path, wrong, said):
    path = tmp_path / "memory.yaml"
    write(path, MEMORY)
    key = wrong.split(":")[0]
    lines = path.read_text().splitlines()
    spot = next((i for i, line in enumerate(lines) if line.strip("- ").startswith(f"{key}:")), None)
    if spot is None:
        lines.append(f"  {wrong}")
    else:
        lines[spot] = lines[spot].split(key)[0] + wrong
    path.write_text("\n".join(lines))
    with pytest.raises(InputError, match=said) as refusal:
        read(path)
    assert str(path) in str(refusal.value)


def test_a_covariance_beyond_its_variances_is_refused():
    with pytest.raises(InputError, match="bound the covariance"):
        Mounting(0.0, 0.0, 1e-6, 1e-3, 1e-6)


def test_rows_whose_covariances_contradict_each_other_are_refused():
    with pytest.raises(InputError, match="bound the covariances"):
        Memory(MEMORY.mounting, (), Rows((0.0, 0.0), (0.04, 0.09), 0.1, (0.0, 0.0), (0.0, 0.0)))


def test_remembering_and_recalling_the_calibration_are_inverse():
    calibration = Calibration(Settings(), FOCAL_PX)
    recall(calibration, MEMORY)
    assert remember(calibration, []) == Memory(MEMORY.mounting, (), ROWS)


def test_a_file_from_before_the_rows_were_learned_still_tells_the_mounting(tmp_path):
    path = tmp_path / "memory.yaml"
    write(path, MEMORY)
    path.write_text(path.read_text().split("rows:")[0])
    calibration = Calibration(Settings(), FOCAL_PX)
    fresh = calibration.covariance.copy()
    recall(calibration, read(path))
    assert calibration.mean.tolist() == [0.003, -0.01, *Settings().bottom_bias_px]
    np.testing.assert_array_equal(calibration.covariance[2:], fresh[2:])
    assert calibration.covariance[0, 0] == 1e-6


def test_rows_learned_in_one_drive_serve_the_next():
    """Potholes drawn 1.5 px too low, which is 0.10 m at 6 m: found by the wheel, and the next drive knows."""
    holes = tuple(Pothole(40.0 + 30.0 * i, 0.08, 0.7, 0.7, y_m=0.75) for i in range(6))
    bumps = tuple(HalfSineBump(55.0 + 30.0 * i, 0.08, 0.4) for i in range(5))
    low = BoxErrors(bottom_bias_px=(0.0, 1.5), top_bias_px=(0.0, 0.0))
    shots, first = drive(Road(230.0, holes + bumps), Drive(seed=2, errors=low))
    rows = first.memory().rows
    assert rows.bottom_px[1] - rows.bottom_px[0] == pytest.approx(1.5, abs=0.5)
    calibration = Calibration(Settings(bottom_bias_px=(0.0, 0.0)), FOCAL_PX)
    recall(calibration, Memory(MEMORY.mounting, (), rows))
    low_px = [FOCAL_PX * calibration.prior(cls).mean[2] for cls in (0, 1)]
    np.testing.assert_allclose(low_px, rows.bottom_px, atol=1e-12)
    at_first, later = (np.mean([abs(shot.error_m) for shot in part]) for part in (shots[:1], shots[3:6]))
    assert later < max(at_first, 0.05)


def test_remembered_objects_are_expected_where_they_were():
    settings = Settings()
    tracks = expectations(MEMORY, Calibration(settings, FOCAL_PX), settings, x_m=2.0)
    assert [track.cls for track in tracks] == [0, 1]
    assert all(track.confirmed for track in tracks)
    for track, place in zip(tracks, MEMORY.objects, strict=True):
        assert track.start_m == pytest.approx(place.x_m, abs=1e-6)
        assert track.end_m - track.start_m == pytest.approx(place.length_m, rel=0.05)  # priors weigh in
        drift = np.sqrt(2) * settings.odometry_sigma * (place.x_m - 2.0)
        assert track.best.sigma_m == pytest.approx(np.hypot(place.x_sigma_m, drift), rel=1e-3)


def test_new_objects_get_numbers_of_their_own():
    settings = Settings()
    tracker = Tracker(settings, FOCAL_PX)
    tracker.expect(expectations(MEMORY, tracker.calibration, settings, x_m=2.0))
    assert tracker._next_identity == 2
