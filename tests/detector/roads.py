"""Synthetic test roads: grey images with a white bar (bump) or a dark blob (pothole)."""

from pathlib import Path

import cv2
import numpy as np

from foreride.detector.data.yolo_folder import Sample


def draw(rng: np.random.Generator, width: int = 128, height: int = 96) -> tuple[np.ndarray, np.ndarray]:
    """Image and its labels (n, 5): class, then the box x0 y0 x1 y1 in pixels."""
    image = rng.integers(90, 120, (height, width, 3), dtype=np.uint8)
    y, x, w = int(rng.integers(8, 40)), int(rng.integers(4, 40)), int(rng.integers(50, 80))
    image[y : y + 8, x : x + w] = 240
    rows = [(0, x, y, x + w, y + 8)]
    y, x = int(rng.integers(56, 76)), int(rng.integers(4, 90))
    image[y : y + 14, x : x + 26] = 20
    rows.append((1, x, y, x + 26, y + 14))
    return image, np.array(rows, float)


def made(seed: int) -> Sample:
    """Labelled sample of such an image at 256 x 192 in plain colours, in memory."""
    image, rows = draw(np.random.default_rng(seed), 256, 192)
    image[:] = 110
    for cls, x0, y0, x1, y1 in rows.astype(int):
        image[y0:y1, x0:x1] = 250 if cls == 0 else 0
    return Sample(
        "a.png", image, rows[:, 0].astype(int), (rows[:, 1:] / [256, 192, 256, 192]).astype(np.float32)
    )


def write(folder: Path, count: int, seed: int = 0) -> Path:
    """Data set folder of such images, without objects.jsonl."""
    rng = np.random.default_rng(seed)
    (folder / "images").mkdir(parents=True)
    (folder / "labels").mkdir()
    for i in range(count):
        image, rows = draw(rng)
        height, width = image.shape[:2]
        cv2.imwrite(str(folder / "images" / f"{i:03}.png"), image[..., ::-1])
        centre, size = (rows[:, 1:3] + rows[:, 3:]) / 2, rows[:, 3:] - rows[:, 1:3]
        table = np.c_[rows[:, 0], centre / [width, height], size / [width, height]]
        text = "".join(f"{int(r[0])} " + " ".join(f"{v:.6f}" for v in r[1:]) + "\n" for r in table)
        (folder / "labels" / f"{i:03}.txt").write_text(text)
    return folder
