"""What one drive leaves for the next: files, and a second drive that starts better informed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from files.errors import InputError
from preview.calibration import Calibration
from preview.memory import Memory, Mounting, Remembered, expectations, read, recall, remember, write
from preview.settings import Settings
from preview.tracker import Tracker

BUMP = Remembered("bump", 60.0, 0.03, 0.5, 0.05, 0.08, 0.01, -3.0, 3.0, 0.1, 0.95)
HOLE = Remembered("pothole", 90.0, 0.05, 0.6, 0.1, 0.07, 0.02, -1.0, -0.4, 0.05, 0.9)
MEMORY = Memory(Mounting(0.003, -0.01, 1e-6, 1e-7, 1e-4), (BUMP, HOLE))

sizes = st.floats(0.01, 5.0)


@given(st.floats(-1e3, 1e3), sizes, sizes, sizes, st.floats(0.01, 0.99))
def test_a_file_gives_back_what_was_written(tmp_path_factory, x, sigma, length, height, existence):
    place = Remembered("hump", x, sigma, length, sigma, height, sigma, -1.0, 1.0, sigma, existence)
    path = tmp_path_factory.mktemp("memory") / "memory.yaml"
    write(path, Memory(MEMORY.mounting, (place,)))
    assert read(path) == Memory(MEMORY.mounting, (place,))


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


def test_remembering_and_recalling_the_mounting_are_inverse():
    calibration = Calibration(Settings())
    recall(calibration, MEMORY)
    assert remember(calibration, []).mounting == MEMORY.mounting


def test_remembered_objects_are_expected_where_they_were():
    settings = Settings()
    tracks = expectations(MEMORY, Calibration(settings), settings, x_m=2.0)
    assert [track.cls for track in tracks] == [0, 1]
    assert all(track.confirmed for track in tracks)
    for track, place in zip(tracks, MEMORY.objects, strict=True):
        assert track.start_m == pytest.approx(place.x_m, abs=1e-6)
        assert track.end_m - track.start_m == pytest.approx(place.length_m, rel=0.05)  # priors weigh in
        drift = np.sqrt(2) * settings.odometry_sigma * (place.x_m - 2.0)
        assert track.best.sigma_m == pytest.approx(np.hypot(place.x_sigma_m, drift), rel=1e-3)


def test_new_objects_get_numbers_of_their_own():
    settings = Settings()
    tracker = Tracker(settings)
    tracker.expect(expectations(MEMORY, tracker.calibration, settings, x_m=2.0))
    assert tracker._next_identity == 2
