"""Contact sheet of photographs with flat-road distances of the boxes on them.

`python -m benchmarks.real_ranges --data DIR [--count 12] [--height-m 1.3] [--focal 0.8] [--horizon 0.28]
--out FILE.png`, DIR with `images/` and `labels/` (YOLO).

The mounting of these cameras is unknown. Assumed, and printed on the sheet: the camera's height above the
road, its focal length in image widths, and the row of the horizon in image heights (below 0: above the
image). Lines across the road mark 5, 10 and 20 m; a distance can only be judged by lane widths and vehicles
near it.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from benchmarks.command import command
from foreride.detector.data.image_io import read_image
from foreride.detector.data.yolo_folder import image_paths, read_labels
from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_bytes
from foreride.preview.geometry.ground_distance import depression, distance_of, row_of
from foreride.road.camera.pinhole import Camera

TILE_PX = (420, 280)
COLUMNS = 4
MARKS_M = (5.0, 10.0, 20.0)


def ranges(camera: Camera, horizon_row: float, height_m: float, rows: np.ndarray) -> np.ndarray:
    """Distance along the road (m) of image rows, NaN above the horizon, which determines the pitch."""
    pitch = -depression(camera, horizon_row)
    return distance_of(height_m, depression(camera, rows) + pitch)


def tile(image: np.ndarray, boxes: np.ndarray, height_m: float, focal: float, horizon: float) -> np.ndarray:
    """Photograph with its boxes (n, 4) xyxy px, their distances and the marks."""
    height, width = image.shape[:2]
    camera = Camera(width, height, focal * width)
    row = horizon * height
    shown = image.copy()
    for metres in MARKS_M:
        at = float(row_of(camera, np.arctan2(height_m, metres) + depression(camera, row)))
        cv2.line(shown, (0, round(at)), (width, round(at)), (90, 200, 90), 1)
        cv2.putText(
            shown, f"{metres:g} m", (3, round(at) - 2), cv2.FONT_HERSHEY_SIMPLEX, width / 1100, (90, 200, 90)
        )
    for box, metres in zip(boxes, ranges(camera, row, height_m, boxes[:, 3]), strict=True):
        left, top, right, bottom = (round(float(value)) for value in box)
        cv2.rectangle(shown, (left, top), (right, bottom), (255, 170, 0), max(1, width // 300))
        where = (left, max(top - 4, 12))
        told = f"{metres:.1f} m" if np.isfinite(metres) else "over the horizon"
        cv2.putText(shown, told, where, cv2.FONT_HERSHEY_SIMPLEX, width / 700, (255, 60, 0), 2)
    return cv2.resize(shown, TILE_PX, interpolation=cv2.INTER_AREA)


@command
def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="distances on photographs")
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--height-m", type=float, default=1.3)
    parser.add_argument("--focal", type=float, default=0.8, help="in image widths")
    parser.add_argument("--horizon", type=float, default=0.28, help="in image heights from the top")
    parser.add_argument("--out", type=Path, required=True)
    asked = parser.parse_args(arguments)
    for name in ("count", "height_m", "focal"):
        if not 0 < getattr(asked, name) < np.inf:
            option = name.replace("_", "-")
            raise InputError(f"--{option} must be finite and > 0, got {getattr(asked, name):g}")
    images = image_paths(asked.data)
    chosen = images[:: max(1, len(images) // asked.count)][: asked.count]
    tiles = []
    for path in chosen:
        image = read_image(path)
        _, boxes = read_labels(asked.data / "labels" / f"{path.stem}.txt")
        tiles.append(
            tile(image, boxes * np.tile(image.shape[1::-1], 2), asked.height_m, asked.focal, asked.horizon)
        )
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % COLUMNS)
    sheet = np.vstack([np.hstack(tiles[k : k + COLUMNS]) for k in range(0, len(tiles), COLUMNS)])
    told = f"assumed: camera {asked.height_m:g} m high, focal length {asked.focal:g} widths"
    told += f", horizon at {asked.horizon:g} of the height"
    head = np.full((28, sheet.shape[1], 3), 255, np.uint8)
    cv2.putText(head, told, (8, 20), cv2.FONT_HERSHEY_SIMPLEX, 0.6, (0, 0, 0), 1, cv2.LINE_AA)
    png = cv2.imencode(".png", cv2.cvtColor(np.vstack([head, sheet]), cv2.COLOR_RGB2BGR))[1]
    write_bytes(asked.out, png.tobytes())
    print(f"{len(chosen)} photographs: {asked.out}")


if __name__ == "__main__":
    raise SystemExit(main())
