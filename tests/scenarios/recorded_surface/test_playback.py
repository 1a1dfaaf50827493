"""Replay of a recorded surface in the layout of RSRD: a small sequence of a known bump, and broken ones."""

import json
import pickle
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.preview.height.plane_parallax import band, project_structure
from foreride.preview.height.stereo import second_pose
from foreride.road.camera.pinhole import Camera, CameraPose
from foreride.scenarios.cli import main
from foreride.scenarios.definition.loading import load
from foreride.scenarios.recorded_surface.pickled import read_pickle
from foreride.scenarios.recorded_surface.playback import plane_pose, replay_surface
from foreride.scenarios.recorded_surface.sequence import SurfaceSequence

STEP_M, COUNT, CAMERA_M, BUMP_M = 1.5, 8, 1.1, 15.0
CAR = (
    "title: A car\nspeed_kmh: 30\nvehicle: {model: full}\nroad: {length_m: 100}\n"
    "elevation: {sensor: {kind: lidar_64, behind_front_axle_m: 1.0}}\n"
)
PITCH = np.deg2rad(12.0)
LIDAR_TO_CAMERA = np.array(
    [[1.0, 0.0, 0.0], [0.0, -np.sin(PITCH), -np.cos(PITCH)], [0.0, np.cos(PITCH), -np.sin(PITCH)]]
)
"""The LiDAR's axes are right, forward, up; the camera is pitched down."""
OFFSET = np.array([[0.05], [-0.3], [0.1]])


def height(x: np.ndarray) -> np.ndarray:
    return np.where(np.abs(x - BUMP_M) < 0.3, 0.06 * np.cos((x - BUMP_M) / 0.6 * np.pi), 0.0)


def stamp(k: int) -> str:
    return f"202304080239{9 + 0.2 * k:06.3f}"


def cloud(camera_x_m: float, rng: np.random.Generator) -> np.ndarray:
    """Points in axes of the LiDAR of a camera at this place."""
    ahead, left = rng.uniform(2.5, 14.0, 6000), rng.uniform(-1.5, 1.5, 6000)
    road = np.stack([-left, np.zeros(6000), ahead])  # right, down, forward of a level camera
    road[1] = CAMERA_M - height(camera_x_m + ahead) + 0.005 * rng.standard_normal(6000)
    level = np.array(
        [[1.0, 0.0, 0.0], [0.0, np.cos(PITCH), -np.sin(PITCH)], [0.0, np.sin(PITCH), np.cos(PITCH)]]
    )
    return (np.linalg.inv(LIDAR_TO_CAMERA) @ (level @ road - OFFSET)).T


def write_pcd(path: Path, points: np.ndarray) -> None:
    head = (
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
        f"WIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(points)}\nDATA binary\n"
    )
    path.write_bytes(head.encode() + points.astype("<f4").tobytes())


def pose(k: int) -> dict[str, Any]:
    """A drive to the west, 1.5 m a frame."""
    lon = 120.0 - np.degrees(STEP_M * k / (6_371_000.0 * np.cos(np.radians(36.0))))
    row = {"time": stamp(k), "lon": float(lon), "lat": 36.0, "alt": 15000.0, "vel_e": -7500.0, "vel_n": 0.0}
    return row | {"yaw": 90.0, "roll": 0.0, "pitch": 0.1}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    sequence = tmp_path / "train" / "2023-04-08-02-39-00-1-conti"
    (sequence / "pcd").mkdir(parents=True)
    rng = np.random.default_rng(0)
    for k in range(COUNT):
        write_pcd(sequence / "pcd" / f"{stamp(k)}.pcd", cloud(STEP_M * k + 0.2, rng))
    (sequence / "loc_pose_vel.pkl").write_bytes(pickle.dumps([pose(k) for k in range(COUNT)]))
    calibration = {"K": np.eye(3), "B": 120.0, "R": LIDAR_TO_CAMERA, "T": OFFSET}
    (tmp_path / "calib_20230408.pkl").write_bytes(pickle.dumps(calibration))
    (tmp_path / "car.yaml").write_text(CAR)
    return sequence


def test_the_bump_is_previewed_before_every_wheel(folder: Path) -> None:
    scenario = load("car.yaml")
    steps = list(replay_surface(SurfaceSequence(folder), scenario))
    assert [step.x_m for step in steps] == pytest.approx([STEP_M * k for k in range(COUNT)], abs=1e-3)
    assert steps[0].camera_height_m == pytest.approx(CAMERA_M, abs=0.01)
    preview, car = steps[-1].preview, scenario.vehicle.parameters
    camera_at_m = steps[-1].x_m + max(car.axle_x_m) - 1.0
    bump_m = BUMP_M + camera_at_m - (STEP_M * (COUNT - 1) + 0.2) - steps[-1].x_m  # from the centre of gravity
    for wheel, axle in enumerate(car.axle_x_m):
        near = np.abs(preview.distance_m - (bump_m - axle)) < 1.5
        heights = preview.height_m[wheel][near] - np.median(preview.height_m[wheel][near])
        assert preview.distance_m[near][heights.argmax()] == pytest.approx(bump_m - axle, abs=0.1)
        assert heights.max() == pytest.approx(0.06, abs=0.015)


def test_the_command_writes_previews_and_summary(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert (
        main(["replay", str(folder), "--scenario", "car.yaml", "--out", "replayed", "--json", "told.json"])
        == 0
    )
    told = json.loads(Path("told.json").read_text())
    assert told["frames"] == COUNT
    assert told["distance_m"] == pytest.approx(STEP_M * (COUNT - 1), abs=1e-3)
    assert told["height_sigma_m"] < 0.006
    assert {path.name for path in Path("replayed").iterdir()} >= {"summary.json", "previews.parquet"}


class _Evil:
    def __reduce__(self) -> tuple[Any, ...]:
        return print, ("executed",)


def broken(folder: Path, kind: str) -> None:
    poses, calibration = folder / "loc_pose_vel.pkl", folder.parents[1] / "calib_20230408.pkl"
    first = folder / "pcd" / f"{stamp(0)}.pcd"
    content: dict[str, tuple[Path, bytes]] = {
        "evil": (poses, pickle.dumps([_Evil()])),
        "cut": (poses, poses.read_bytes()[:60]),
        "no list": (poses, pickle.dumps({"time": 1})),
        "no yaw": (poses, pickle.dumps([{"time": stamp(0), "lon": 1.0, "lat": 2.0}])),
        "nan": (poses, pickle.dumps([pose(0) | {"lat": float("nan")}])),
        "other times": (poses, pickle.dumps([pose(k) | {"time": f"x{k}"} for k in range(3)])),
        "no T": (calibration, pickle.dumps({"R": np.eye(3)})),
        "no rotation": (calibration, pickle.dumps({"R": np.ones((3, 3)), "T": np.zeros(3)})),
        "bad cloud": (first, b"no cloud"),
        "cut cloud": (first, first.read_bytes()[:400]),
        "few points": (first, b""),
    }
    if kind == "few points":
        write_pcd(first, np.zeros((5, 3)))
    elif kind == "no road":
        write_pcd(first, np.full((500, 3), 90.0))
    elif kind == "no calibration":
        calibration.unlink()
    elif kind == "no poses":
        poses.unlink()
    elif kind == "no clouds":
        for path in (folder / "pcd").iterdir():
            path.unlink()
    else:
        path, data = content[kind]
        path.write_bytes(data)


@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("evil", "loc_pose_vel.pkl: must hold plain values and arrays only, not 'builtins.print'"),
        ("cut", "loc_pose_vel.pkl: is invalid"),
        ("no list", "loc_pose_vel.pkl: must hold a list of poses, got 'dict'"),
        ("no yaw", "loc_pose_vel.pkl: pose 0 must have time, lon, lat and yaw"),
        ("nan", "loc_pose_vel.pkl: pose 0 must be a place on earth"),
        ("other times", "at least 2 frames must have a pose in loc_pose_vel.pkl, got 0 of 8"),
        ("no T", "calib_20230408.pkl: must hold R (3, 3) and T (3, 1)"),
        ("no rotation", "calib_20230408.pkl: R must be a rotation"),
        ("bad cloud", f"{stamp(0)}.pcd: is invalid"),
        ("cut cloud", f"{stamp(0)}.pcd: is invalid"),
        ("few points", f"{stamp(0)}.pcd: must hold at least 100 points, got 5"),
        ("no road", f"{stamp(0)}.pcd: must show the road 2 ... 12 m ahead"),
        ("no calibration", "needs the calibration calib_20230408.pkl"),
        ("no poses", "loc_pose_vel.pkl: cannot be read"),
        ("no clouds", "holds no point clouds pcd/*.pcd"),
    ],
)
def test_a_broken_sequence_is_told_in_one_line(
    folder: Path, capsys: pytest.CaptureFixture[str], kind: str, told: str
) -> None:
    broken(folder, kind)
    assert main(["replay", str(folder), "--scenario", "car.yaml", "--out", "replayed"]) == 2
    captured = capsys.readouterr()
    assert told in captured.err
    assert "executed" not in captured.out
    assert not Path("replayed").exists()


def test_arrays_of_older_numpy_are_read(tmp_path: Path) -> None:
    path = tmp_path / "old.pkl"
    path.write_bytes(
        pickle.dumps({"R": np.eye(3), "n": np.float64(2.0)}, protocol=2).replace(
            b"numpy._core", b"numpy.core"
        )
    )
    content = read_pickle(path)
    assert (content["R"] == np.eye(3)).all()
    assert content["n"] == 2.0


def test_the_plane_gives_height_and_attitude() -> None:
    rng = np.random.default_rng(1)
    x, y = rng.uniform(2.0, 12.0, 3000), rng.uniform(-2.0, 2.0, 3000)
    points = np.stack([x, y, -1.3 + 0.2 * x + 0.01 * y], axis=1)
    points[:200, 2] += 0.3
    level_m, rotation = plane_pose(points, "cloud")
    level = points @ rotation.T
    assert np.ptp(level[200:, 2]) < 0.002
    assert level[200:, 2].mean() == pytest.approx(-level_m, abs=1e-3)
    with pytest.raises(InputError, match="cloud: must show the road"):
        plane_pose(points[:10], "cloud")


FOCAL_PX, WIDTH, HEIGHT, BASE_M = 700.0, 640, 400, 0.12
POSE = CameraPose(0.0, 0.0, CAMERA_M, 0.0, float(PITCH), 0.0)


def write_pair(folder: Path, k: int) -> None:
    """Rectified pair of a textured road with the bump."""
    camera, rng = Camera(WIDTH, HEIGHT, FOCAL_PX), np.random.default_rng(k)
    horizon = int(HEIGHT / 2 - FOCAL_PX * np.tan(PITCH)) + 60
    below = Camera(WIDTH, HEIGHT - horizon, FOCAL_PX, (WIDTH / 2, HEIGHT / 2 - horizon))
    view = band(below, POSE, second_pose(POSE, BASE_M), (0, below.height_px), (0, WIDTH))
    texture = cv2.GaussianBlur(rng.uniform(0, 255, (camera.height_px, WIDTH)).astype(np.float32), (0, 0), 1.0)
    right = cv2.normalize(texture, None, 20, 235, cv2.NORM_MINMAX).astype(np.uint8)
    axes, point = POSE.rotation, np.stack([view.ahead, view.side, view.up])
    relief = height(STEP_M * k + 0.2 + np.tensordot(axes[0], point, axes=1))
    at = project_structure(below, view, (1.0 / (1.0 - relief / CAMERA_M)).astype(np.float32))
    left = right.copy()
    left[horizon:] = cv2.remap(right[horizon:], *at[:2], cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT)
    for side, image in (("left", left), ("right", right)):
        (folder / side).mkdir(exist_ok=True)
        cv2.imwrite(str(folder / side / f"{stamp(k)}.jpg"), image, [cv2.IMWRITE_JPEG_QUALITY, 100])


@pytest.fixture
def pairs(folder: Path) -> Path:
    for k in range(COUNT):
        write_pair(folder, k)
    intrinsics = [[FOCAL_PX, 0.0, WIDTH / 2 - 0.5], [0.0, FOCAL_PX, HEIGHT / 2 - 0.5], [0.0, 0.0, 1.0]]
    calibration = {"K": np.array(intrinsics), "B": 1e3 * BASE_M, "R": LIDAR_TO_CAMERA, "T": OFFSET}
    (folder.parents[1] / "calib_20230408.pkl").write_bytes(pickle.dumps(calibration))
    camera = "camera: {height_m: 1.08, pitch_deg: 11.8}\n"
    sensor = "{kind: stereo_30cm, base_m: 0.12, focal_px: 700, width_px: 640, height_px: 400, "
    car = CAR.replace("{kind: lidar_64, ", sensor)
    (folder.parents[1] / "car.yaml").write_text(car + camera)
    return folder


def test_stereo_pairs_give_the_bump_too(pairs: Path) -> None:
    scenario = load("car.yaml")
    steps = list(replay_surface(SurfaceSequence(pairs, stereo=True), scenario, from_images=True))
    assert steps[-1].camera_height_m == pytest.approx(CAMERA_M, abs=0.01)
    preview, car = steps[-1].preview, scenario.vehicle.parameters
    # The texture's relief is that of the plane's point on the ray, which lies behind the top of the bump.
    bump_m = (BUMP_M - STEP_M * (COUNT - 1) - 0.2) * (1.0 - 0.06 / CAMERA_M) - 1.0  # from the front axle
    near = np.abs(preview.distance_m - bump_m) < 1.5
    heights = preview.height_m[0][near] - np.median(preview.height_m[0][near])
    assert car.axle_x_m[0] == max(car.axle_x_m)
    assert preview.distance_m[near][heights.argmax()] == pytest.approx(bump_m, abs=0.1)
    assert heights.max() == pytest.approx(0.06, abs=0.015)


@pytest.mark.parametrize(
    ("name", "data", "told"),
    [
        (f"left/{stamp(0)}.jpg", b"no image", f"{stamp(0)}.jpg"),
        (f"right/{stamp(0)}.jpg", None, f"{stamp(0)}.jpg: cannot be read"),
        (
            "../../calib_20230408.pkl",
            pickle.dumps({"K": np.eye(3), "B": 120.0}),
            "K must have a focal length",
        ),
        ("../../calib_20230408.pkl", pickle.dumps({"R": 1.0}), "must hold K (3, 3) in px"),
        ("../../calib_20230408.pkl", pickle.dumps([1]), "must hold K, B, R and T, got 'list'"),
    ],
)
def test_broken_pairs_are_told_in_one_line(
    pairs: Path, capsys: pytest.CaptureFixture[str], name: str, data: bytes | None, told: str
) -> None:
    if data is None:
        (pairs / name).unlink()
    else:
        (pairs / name).write_bytes(data)
    assert main(["replay", str(pairs), "--stereo", "--scenario", "car.yaml", "--out", "replayed"]) == 2
    assert told in capsys.readouterr().err
    assert not Path("replayed").exists()
