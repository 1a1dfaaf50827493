"""Drive memory: files, and a second drive with prior information."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.detector.box_errors import BoxErrors
from foreride.files.errors import InputError
from foreride.preview.obstacle_classes import POTHOLE
from foreride.preview.prior_drives.memory_file import Memory, Mounting, RememberedObject, RowBias, read, write
from foreride.preview.prior_drives.recall import expectations, recall, remember
from foreride.preview.settings import Settings
from foreride.preview.tracking.mounting_filter import Calibration
from foreride.preview.tracking.object_state import HEIGHT, LENGTH, X
from foreride.preview.tracking.tracker import Tracker
from foreride.road.features.feature import HalfSineBump, Pothole
from foreride.road.road import Road
from tests.preview.kinematic_drive import Drive, drive

BUMP = RememberedObject("bump", 60.0, 0.03, 0.5, 0.05, 0.08, 0.01, -3.0, 3.0, 0.1, 0.95)
HOLE = RememberedObject("pothole", 90.0, 0.05, 0.6, 0.1, 0.07, 0.02, -1.0, -0.4, 0.05, 0.9)
ROWS = RowBias((-0.2, 0.9), (0.04, 0.09), 0.01, (1e-5, 2e-5), (1e-5, -3e-5))
MEMORY = Memory(Mounting(0.003, -0.01, 1e-6, 1e-7, 1e-4), (BUMP, HOLE), ROWS)
FOCAL_PX = 457.0

sizes = st.floats(0.01, 5.0)


@given(st.floats(-1e3, 1e3), sizes, sizes, sizes, st.floats(0.01, 0.99))
def test_a_file_gives_back_what_was_written(tmp_path_factory, x, sigma, length, height, existence):
    place = RememberedObject("hump", x, sigma, length, sigma, height, sigma, -1.0, 1.0, sigma, existence)
    path = tmp_path_factory.mktemp("memory") / "memory.yaml"
    write(path, Memory(MEMORY.mounting, (place,), ROWS))
    assert read(path) == Memory(MEMORY.mounting, (place,), ROWS)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ("kind: bumb", "kind must be one of"),
        ("existence: 1.0", "existence must be > 0 and < 1"),
        ("x_sigma_m: 0.0", "x_sigma_m must lie in"),
        ("y_min_m: 4.0", "y_min_m must be <= y_max_m"),
        ("length_m: -0.1", "length_m must lie in"),
        ("length_m: null", "length_m and length_sigma_m must both be null"),
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
        Memory(MEMORY.mounting, (), RowBias((0.0, 0.0), (0.04, 0.09), 0.1, (0.0, 0.0), (0.0, 0.0)))


def test_rows_known_without_any_doubt_are_refused(tmp_path):
    path = tmp_path / "memory.yaml"
    write(path, MEMORY)
    path.write_text(path.read_text().replace("- 0.04", "- 0.0").replace("- 0.09", "- 0.0"))
    with pytest.raises(InputError, match=r"memory\.yaml: rows\.variance\[0\] must lie in 1e-12 \.\.\. "):
        read(path)


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
    assert calibration.mean.tolist() == [0.003, -0.01, *Settings().edge_bias_px[1]]
    np.testing.assert_array_equal(calibration.covariance[2:], fresh[2:])
    assert calibration.covariance[0, 0] == 1e-6


EDGE_BIAS = BoxErrors(bottom_bias_px=(0.0, 1.5), top_bias_px=(0.0, 0.0))
"""Potholes drawn 1.5 px too low, which is 0.10 m at 6 m: found by the wheel."""


def holes_and_bumps(count):
    holes = tuple(Pothole(40.0 + 30.0 * i, 0.08, 0.7, 0.7, y_m=0.75) for i in range(count))
    bumps = tuple(HalfSineBump(55.0 + 30.0 * i, 0.08, 0.4) for i in range(count - 1))
    return Road(50.0 + 30.0 * count, holes + bumps)


def test_rows_are_learned_in_a_drive_and_recalled():
    shots, first = drive(holes_and_bumps(6), Drive(seed=2, errors=EDGE_BIAS))
    rows = first.memory().rows
    assert rows.bottom_px[1] - rows.bottom_px[0] == pytest.approx(1.5, abs=0.5)
    calibration = Calibration(Settings(bottom_bias_px=(0.0, 0.0)), FOCAL_PX)
    recall(calibration, Memory(MEMORY.mounting, (), rows))
    low_px = [FOCAL_PX * calibration.prior(cls).mean[2] for cls in (0, 1)]
    np.testing.assert_allclose(low_px, rows.bottom_px, atol=1e-12)
    at_first, later = (np.mean([abs(shot.error_m) for shot in part]) for part in (shots[:1], shots[3:6]))
    assert later < max(at_first, 0.05)


def test_rows_learned_in_one_drive_serve_the_next():
    """The first hole of the next drive is located twice as well, on average over four cars."""
    errors = []
    for seed in range(4):
        conditions = Drive(seed=seed, errors=EDGE_BIAS)
        (before, *_), first = drive(holes_and_bumps(3), conditions)
        memory = replace(first.memory(), objects=())
        (after,), _ = drive(holes_and_bumps(1), conditions, memory=memory)
        errors.append((before.error_m, after.error_m))
    before_m, after_m = np.abs(errors).mean(axis=0)
    assert after_m < 0.5 * before_m


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


def expected(place, settings=None):
    """Single track that awaits `place`, of a car that starts there, with its direct measurements."""
    settings = settings or Settings()
    calibration = Calibration(settings, FOCAL_PX)
    (track,) = expectations(Memory(Mounting(), (place,)), calibration, settings, x_m=place.x_m)
    return track, calibration, settings


def test_one_box_of_the_wrong_class_does_not_turn_what_is_remembered():
    track, calibration, settings = expected(BUMP)
    for seen_as in (1, 0, 1):
        track.classify(seen_as, calibration.prior(seen_as), settings)
        assert (track.cls, track.best.kind.name) == (0, "bump")
    assert {measurement.entry for measurement in track.direct_measurements} == {X, LENGTH, HEIGHT}


def test_what_has_turned_forgets_the_size_of_its_old_class_but_not_its_place():
    track, calibration, settings = expected(BUMP)
    for _ in range(5):
        track.classify(1, calibration.prior(1), settings)
    track.refit(calibration.prior(1), settings)
    assert track.cls == 1
    assert [measurement.entry for measurement in track.direct_measurements] == [X]
    assert track.start_m == pytest.approx(BUMP.x_m, abs=1e-3)
    kind = track.best.kind
    assert track.best.state[[LENGTH, HEIGHT]].tolist() == pytest.approx([kind.length_m, kind.height_m])


def test_a_depth_that_was_measured_once_is_not_guessed_again():
    track, *_ = expected(replace(HOLE, height_m=0.11, height_sigma_m=0.005))
    assert track.section(track.centre_y_m).height_m == pytest.approx(0.11, abs=0.005)


def test_a_depth_that_nothing_measured_is_not_remembered(tmp_path):
    _, estimator = drive(Road(70.0, (Pothole(40.0, 0.08, 0.7, 0.7, y_m=0.75),)), Drive())
    (place,) = estimator.memory().objects
    assert place.length_m == pytest.approx(0.7, abs=0.3)
    assert (place.height_m, place.height_sigma_m) == (None, None)
    write(tmp_path / "memory.yaml", estimator.memory())
    assert read(tmp_path / "memory.yaml") == estimator.memory()
    track, *_ = expected(place)
    section = track.section(track.centre_y_m)
    assert section.height_m == pytest.approx(POTHOLE.height_m)


@pytest.mark.parametrize("place", [BUMP, HOLE], ids=lambda place: place.kind)
def test_drives_that_see_nothing_leave_sizes_as_they_were(place):
    """The prior of a kind counts once, in the fit, and not once a drive."""
    settings = Settings()
    calibration = Calibration(settings, FOCAL_PX)
    memory = Memory(Mounting(), (place,))
    for _ in range(4):
        memory = remember(calibration, expectations(memory, calibration, settings, place.x_m))
    (after,) = memory.objects
    for name in ("length_m", "length_sigma_m", "height_m", "height_sigma_m", "x_m", "x_sigma_m"):
        assert getattr(after, name) == pytest.approx(getattr(place, name), rel=1e-6)


def test_new_objects_get_numbers_of_their_own():
    settings = Settings()
    tracker = Tracker(settings, FOCAL_PX)
    tracker.expect(expectations(MEMORY, tracker.calibration, settings, x_m=2.0))
    assert tracker._next_identity == 2
