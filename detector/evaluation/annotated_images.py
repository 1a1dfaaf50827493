"""Annotated images with true and detected boxes, and contact sheets of them."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.detector.evaluation.average_precision import ImageResult
from foreride.road.obstacle_classes import OBSTACLE_CLASSES

TRUE, MISSED, RIGHT, FALSE = (255, 255, 255), (255, 210, 0), (60, 230, 90), (255, 60, 60)
CAPTION_PX, MARGIN_PX = 20, 4
KEY = "true: white, missed: yellow; found: green, false: red"


def tile(
    image: NDArray[np.uint8],
    boxes: NDArray[np.float32],
    result: ImageResult,
    confidence: float,
    name: str = "",
    width: int = 480,
) -> NDArray[np.uint8]:
    """Annotated image, `width` pixels wide, with a caption; detections from a score of `confidence` on.

    image: (H, W, 3) RGB. boxes (n, 4): the true ones; result: their matched detections, both in the image's
    pixels.
    """
    scale = width / image.shape[1]
    size = (width, round(image.shape[0] * scale))
    interpolation = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
    picture = cv2.resize(image, size, interpolation=interpolation)
    missed, confident = missed_mask(result, confidence), result.detections.scores >= confidence
    for box, is_missed in zip(boxes * scale, missed, strict=True):
        draw_box(picture, box, MISSED if is_missed else TRUE)
    detections, is_hit = result.detections, result.hits[0]
    for i in np.flatnonzero(confident)[::-1]:
        colour = RIGHT if is_hit[i] else FALSE
        draw_box(picture, detections.boxes[i] * scale, colour)
        label = f"{OBSTACLE_CLASSES[detections.classes[i]].label} {detections.scores[i]:.2f}"
        draw_text(picture, label, detections.boxes[i, :2] * scale - (0, 3), colour)
    counts = f"{missed.sum()} missed, {int((confident & ~is_hit).sum())} false of {len(boxes)}"
    caption = np.full((CAPTION_PX, width, 3), 24, np.uint8)
    draw_text(caption, f"{name}   {counts}", (4, CAPTION_PX - 6), TRUE)
    return np.concatenate((picture, caption)).astype(np.uint8, copy=False)


def missed_mask(result: ImageResult, confidence: float) -> NDArray[np.bool_]:
    """(m,) bool: true objects without a detection of a score of at least `confidence`."""
    scores = np.append(result.detections.scores, 0.0)
    return scores[result.matched] < confidence


def sheet(tiles: Sequence[NDArray[np.uint8]], columns: int, title: str) -> NDArray[np.uint8]:
    """Contact sheet: tiles of one width, row by row, below a title."""
    width = tiles[0].shape[1]
    rows = []
    for start in range(0, len(tiles), columns):
        row = tiles[start : start + columns]
        height = max(t.shape[0] for t in row) + MARGIN_PX
        canvas = np.full((height, columns * (width + MARGIN_PX), 3), 24, np.uint8)
        for i, tile_image in enumerate(row):
            x = i * (width + MARGIN_PX)
            canvas[: tile_image.shape[0], x : x + width] = tile_image
        rows.append(canvas)
    header = np.full((CAPTION_PX + MARGIN_PX, rows[0].shape[1], 3), 24, np.uint8)
    draw_text(header, title, (4, CAPTION_PX - 4), TRUE)
    return np.concatenate((header, *rows))


def png(image: NDArray[np.uint8]) -> bytes:
    """RGB image encoded as PNG."""
    return cv2.imencode(".png", image[..., ::-1])[1].tobytes()


def draw_box(image: NDArray, box: NDArray, colour: tuple[int, int, int]) -> None:
    """Box, drawn just outside its edges so that thin objects stay visible."""
    (x0, y0), (x1, y1) = np.floor(box[:2]).astype(int) - 1, np.ceil(box[2:]).astype(int)
    cv2.rectangle(image, (int(x0), int(y0)), (int(x1), int(y1)), colour, 1)


def draw_text(image: NDArray, content: str, at: Sequence[float], colour: tuple[int, int, int]) -> None:
    """Text in that colour on a dark ground, kept within the left and top border."""
    (width, height), below = cv2.getTextSize(content, cv2.FONT_HERSHEY_SIMPLEX, 0.38, 1)
    x, y = max(int(at[0]), 0), max(int(at[1]), height + 1)
    cv2.rectangle(image, (x, y - height - 1), (x + width, y + below // 2), (24, 24, 24), -1)
    cv2.putText(image, content, (x, y), cv2.FONT_HERSHEY_SIMPLEX, 0.38, colour, 1, cv2.LINE_AA)
