"""`foreride calibrate`: camera calibration from checkerboard photographs, as a scenario's camera block."""

import argparse
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import yaml

from foreride.files.errors import InputError, shown
from foreride.files.reading import strict
from foreride.files.reading.images import read_pixels
from foreride.files.reading.numbers import is_integer
from foreride.files.writing.atomic import write_text
from foreride.road.camera.calibration import (
    MIN_VIEWS,
    Board,
    Calibration,
    Mounting,
    calibrate,
    find_corners,
    mounting,
)
from foreride.scenarios.commands.console import console, tracked
from foreride.scenarios.commands.options import add_json_option
from foreride.scenarios.runs.write import to_json

CHECK_FAILED = 1
_BLURRED_PX = 0.5


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    command.add_argument("photos", nargs="+", type=Path, metavar="PHOTO", help="at least 4, better 15")
    command.add_argument("--squares", required=True, metavar="9x6", help="squares across and down the board")
    command.add_argument("--square_m", required=True, type=float, metavar="0.03", help="side of a square")
    command.add_argument(
        "--ground", type=Path, metavar="PHOTO", help="one with the board flat on the road: height and pitch"
    )
    command.add_argument(
        "--out", type=Path, metavar="FILE", help="write the block `camera` of a scenario (YAML)"
    )
    add_json_option(command, "write all numbers as JSON")
    command.set_defaults(execute=execute, out_is_file=True)


def execute(arguments: argparse.Namespace) -> int:
    """Detect the boards, fit the camera, report; return 1 if the reprojection error is large."""
    board = _board(arguments.squares, arguments.square_m)
    corners_by_photo, size = _views(arguments.photos, board)
    missed = [str(path) for path in arguments.photos if path not in corners_by_photo]
    if len(corners_by_photo) < MIN_VIEWS:
        raise InputError(
            f"the whole board of {arguments.squares} squares was found in {len(corners_by_photo)} of "
            f"{len(arguments.photos)} photographs, {MIN_VIEWS} are needed; not in {', '.join(missed)}"
        )
    calibration = calibrate(list(corners_by_photo.values()), board, *size)
    mount = None if arguments.ground is None else _mount(arguments.ground, calibration, board, size)
    for path, error in zip(corners_by_photo, calibration.views_px, strict=True):
        console.print(f"{path}: {error:.2f} px")
    for name in missed:
        console.print(f"{name}: no whole board found, left out")
    console.print(_summary(calibration, mount))
    if arguments.out:
        write_text(arguments.out, _block(calibration, mount))
        console.print(f"camera: {arguments.out}")
    if arguments.json:
        write_text(arguments.json, to_json(_document(calibration, mount, list(corners_by_photo))) + "\n")
    if calibration.rms_px > _BLURRED_PX:
        console.print(
            f"an error above {_BLURRED_PX:g} px: is the board flat, --squares right, a photo blurred?"
        )
        return CHECK_FAILED
    return 0


def _board(squares: str, square_m: float) -> Board:
    columns, cross, rows = squares.partition("x")
    counts = [int(text) for text in (columns, rows) if is_integer(text)]
    if not (cross and len(counts) == 2 and min(counts) >= 4 and max(counts) <= 100):
        raise InputError(f"--squares must be like 9x6, each 4 ... 100, got {shown(squares)}")
    if not 0.001 <= square_m <= 1.0:
        raise InputError(f"--square_m must lie in 0.001 ... 1 m, got {square_m:g}")
    return Board(counts[0], counts[1], square_m)


def _views(photos: Sequence[Path], board: Board) -> tuple[dict[Path, np.ndarray], tuple[int, int]]:
    """Corners in each photo that shows the whole board, and the common size of all photos (width, height)."""
    corners_by_photo, sizes = {}, {}
    for path in tracked(photos, "looking for the board"):
        image = _photo(path)
        sizes[path] = image.shape[1::-1]
        if sizes[path] != sizes[photos[0]]:
            expected_size, actual_size = (
                f"{width}x{height}" for width, height in (sizes[photos[0]], sizes[path])
            )
            raise InputError(f"{path}: is {actual_size} px; must be {expected_size} px as {photos[0]} is")
        corners = find_corners(image, board)
        if corners is not None:
            corners_by_photo[path] = corners
    return corners_by_photo, sizes[photos[0]]


def _photo(path: Path) -> np.ndarray:
    """(H, W) grey image in sensor orientation; the file's own rotation would rotate the lens."""
    return np.asarray(read_pixels(path, cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION), np.uint8)


def _mount(path: Path, calibration: Calibration, board: Board, size: tuple[int, int]) -> Mounting:
    corners_by_photo, photo_size = _views([path], board)
    if photo_size != size:
        raise InputError(
            f"{path}: is {photo_size[0]}x{photo_size[1]} px; must be {size[0]}x{size[1]} px as the others are"
        )
    if not corners_by_photo:
        raise InputError(f"{path}: the whole board was not found")
    return mounting(calibration.camera, corners_by_photo[path], board)


def _summary(calibration: Calibration, mount: Mounting | None) -> str:
    camera, (focal, across, down) = calibration.camera, calibration.sigma_px
    text = (
        f"{len(calibration.views_px)} views, reprojection error {calibration.rms_px:.3f} px (RMS)\n"
        f"focal length {camera.focal_px:.2f} ± {focal:.2f} px, principal point "
        f"{camera.cx:.2f} ± {across:.2f}, {camera.cy:.2f} ± {down:.2f} px\n"
        f"distortion k1, k2, p1, p2, k3: {', '.join(f'{value:.5f}' for value in camera.distortion)}"
    )
    if mount is None:
        return text
    return (
        f"{text}\nheight {mount.height_m:.3f} m, pitch {mount.pitch_deg:.2f}°, roll {mount.roll_deg:.2f}° "
        "(a mounted camera is taken to have no roll)"
    )


def _block(calibration: Calibration, mount: Mounting | None) -> str:
    camera = {"intrinsics": strict.to_mapping(calibration.camera)}
    placed = {} if mount is None else {"height_m": mount.height_m, "pitch_deg": mount.pitch_deg}
    camera |= {name: round(value, 4) for name, value in placed.items()}
    views, rms_px = len(calibration.views_px), calibration.rms_px
    header = f"# {views} views of a checkerboard, reprojection error {rms_px:.3f} px\n"
    return header + yaml.safe_dump({"camera": camera}, sort_keys=False, default_flow_style=None)


def _document(calibration: Calibration, mount: Mounting | None, photos: list[Path]) -> dict:
    return {
        "schema": 1,
        "camera": strict.to_mapping(calibration.camera),
        "rms_px": calibration.rms_px,
        "views": [
            {"photo": str(path), "rms_px": error}
            for path, error in zip(photos, calibration.views_px, strict=True)
        ],
        "sigma_px": dict(zip(("focal", "cx", "cy"), calibration.sigma_px, strict=True)),
        "mounting": None if mount is None else mount._asdict(),
    }
