"""Vertical alignment: heights by closed form, and rendered views of changing grades."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.files.errors import InputError
from foreride.road.camera.pinhole import Camera, CameraMount, CameraPose, horizon_row, pose_of, project, rays
from foreride.road.features.feature import HalfSineBump
from foreride.road.render.appearance import Appearance
from foreride.road.render.outline_boxes import outline_boxes
from foreride.road.render.raycast import FAR_M
from foreride.road.render.scene import Scene
from foreride.road.road import Road
from foreride.road.vertical_alignment import MAX_GRADE, GradeChange, grade_at, grade_height

UP, LEVEL = GradeChange(10.0, 0.02, 2.0), GradeChange(20.0, 0.0, 4.0)


def test_the_curve_is_a_parabola_between_straight_lines() -> None:
    height = grade_height((UP, LEVEL), [0.0, 10.0, 11.0, 12.0, 20.0, 24.0, 100.0])
    # The curve is a parabola: at its end it has risen by half of the change of grade times its length.
    np.testing.assert_allclose(height, [0, 0, 0.005, 0.02, 0.18, 0.22, 0.22], atol=1e-12)


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(0.1, 9.0), st.floats(0.1, 20.0))
def test_grades_are_those_asked_for(first: float, second: float, one_m: float, other_m: float) -> None:
    changes = (GradeChange(10.0, first, one_m), GradeChange(20.0, second, other_m))
    x = np.array([19.4, 19.5, 60.0, 60.1])
    z = grade_height(changes, x)
    np.testing.assert_allclose((z[1::2] - z[::2]) / (x[1::2] - x[::2]), [first, second], atol=1e-9)


def test_a_road_carries_its_features_over_the_grade() -> None:
    bump = HalfSineBump(15.0, 0.08, 0.5)
    road = Road(60.0, (bump,), grades=(UP,))
    assert not road.is_flat_between_features
    assert road.height(15.25, 0.0) == pytest.approx(0.08 + 0.02 * (15.25 - 11.0))


@pytest.mark.parametrize("grade", [0.02, -0.02])
def test_the_camera_sees_a_bump_where_the_grade_puts_it(grade: float) -> None:
    change, bump = GradeChange(8.0, grade), HalfSineBump(18.0, 0.08, 0.5)
    camera, pose = Camera(), pose_of(CameraMount(), 5.0, 0.0, 0.0)
    scene = Scene(Road(60.0, (bump,), grades=(change,)), Appearance(), 1)
    frame = scene.render(camera, pose, 0)
    edge = (18.0, 0.0, grade * (18.0 - 9.0))
    assert frame.boxes[0][3] == pytest.approx(project(camera, pose, edge)[0, 1], abs=1.0)


def test_the_plane_beyond_the_map_meets_it() -> None:
    """Depth is continuous where the rays leave the map, 46 m ahead."""
    scene = Scene(Road(200.0, grades=(GradeChange(5.0, 0.02),)), Appearance(), 1)
    frame = scene.render(Camera(), pose_of(CameraMount(), 4.0, 0.0, 0.0), 0)
    column = frame.depth[:, 320]
    far = column[np.isfinite(column) & (column > 20)]
    assert far[0] > 60
    assert np.all(np.diff(far) < 0)
    assert np.abs(np.diff(np.diff(1 / far))).max() < 2e-4  # rows of a plane are even in 1 / depth


def marched(changes: tuple[GradeChange, ...], camera: Camera, pose: CameraPose) -> np.ndarray:
    """Depth (rows,) of the middle column by steps of a centimetre through `grade_height`; inf for sky."""
    rows = np.arange(camera.height_px) + 0.5
    ahead = np.arange(1.0, FAR_M, 0.01)
    ground = grade_height(changes, pose.x + ahead)
    direction = rays(camera, pose, np.stack([np.full(rows.shape, camera.cx), rows], axis=1))
    z = pose.z + ahead * (direction[:, 2] / direction[:, 0])[:, None]
    below_road = z < ground
    at = ahead[below_road.argmax(axis=1)] / direction[:, 0]
    return np.where(below_road.any(axis=1), at, np.inf)


CREST = (GradeChange(8.0, 0.08), GradeChange(30.0, -0.05), GradeChange(60.0, 0.0))
VALLEY = (GradeChange(8.0, -0.08), GradeChange(30.0, 0.1))


@pytest.mark.parametrize("x_m", [3.0, 20.0, 40.0])
@pytest.mark.parametrize(
    "changes",
    [(GradeChange(8.0, grade),) for grade in (-MAX_GRADE, -0.05, 0.05, 0.1, MAX_GRADE)] + [CREST, VALLEY],
    ids=["down 30 %", "down 5 %", "up 5 %", "up 10 %", "up 30 %", "crest", "valley"],
)
def test_the_road_is_where_marching_through_its_height_finds_it(
    changes: tuple[GradeChange, ...], x_m: float
) -> None:
    """Views from the level before and from the grade itself, with sky and hidden road, to the map's end."""
    camera = Camera()
    level = pose_of(CameraMount(), x_m, 0.0, -np.arctan(grade_at(changes, x_m)))
    pose = replace(level, z=level.z + float(grade_height(changes, x_m)))
    scene = Scene(Road(200.0, grades=changes), Appearance(), 1)
    depth = scene.render(camera, pose, 0).depth[:, camera.width_px // 2]
    distance = marched(changes, camera, pose)
    finite = np.isfinite(distance)
    assert finite.any()
    np.testing.assert_allclose(depth[finite], distance[finite], rtol=0.02)
    assert (depth[~finite] > 0.98 * FAR_M).all()


def test_no_road_is_painted_where_only_sky_is_to_be_seen() -> None:
    """Down a slope of 5 % that begins 26 m ahead, all pixels below eye level and beyond the crest are sky."""
    change = GradeChange(40.0, -0.05)
    scene = Scene(Road(200.0, grades=(change,)), Appearance(), 1)
    camera, pose = Camera(), pose_of(CameraMount(), 3.0, 0.0, 0.0)
    depth = scene.render(camera, pose, 0).depth[:, camera.width_px // 2]
    edge = project(camera, pose, [(42.0, 0.0, -0.05)])[0, 1]
    horizon = horizon_row(camera, pose)
    assert horizon < edge - 3
    assert np.isinf(depth[: int(edge) - 1]).all()
    assert np.isfinite(depth[int(edge) + 1 :]).all()


def test_a_bump_up_the_road_is_seen_in_the_box_that_geometry_gives() -> None:
    """On a grade of 10 % from 10 m on, a bump at 28 m, 0.4 m above the camera of a car at 3 m."""
    bump = HalfSineBump(28.0, 0.08, 0.5)
    road = Road(60.0, (bump,), grades=(GradeChange(10.0, 0.1),))
    camera, pose = Camera(1280, 768, 914.0), pose_of(CameraMount(), 3.0, 0.0, 0.0)
    (box,) = Scene(road, Appearance(), 1).render(camera, pose, 0).boxes
    ((true,), _) = outline_boxes(road, camera, pose)
    np.testing.assert_allclose(box[[1, 3]], true[[1, 3]], atol=1.0)
    np.testing.assert_allclose(box[[0, 2]], true[[0, 2]], atol=2.0)  # as on a level road: its ends run out


@pytest.mark.parametrize(
    ("grades", "words"),
    [
        (
            (GradeChange(10.0, 0.02), GradeChange(11.0, 0.0)),
            r"grades\[1\] spans 11 to 13 m and must lie after",
        ),
        ((GradeChange(59.0, 0.02),), r"grades\[0\] spans 59 to 61 m .* length_m = 60 m"),
    ],
)
def test_changes_that_overlap_or_leave_the_road_are_refused(
    grades: tuple[GradeChange, ...], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        Road(60.0, grades=grades)


@pytest.mark.parametrize(
    "change", [{"grade": 0.31}, {"grade": 0.1, "length_m": 0.0}, {"grade": float("nan")}]
)
def test_a_grade_out_of_range_is_refused(change: dict[str, float]) -> None:
    with pytest.raises(InputError, match="must"):
        GradeChange(1.0, **change)
