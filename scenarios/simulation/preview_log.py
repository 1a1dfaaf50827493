"""Preview record of a run: the previews given to the controller, decimated."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from foreride.preview.road_preview import RoadPreview

RATE_HZ = 20
STEP_M = 0.1


@dataclass(frozen=True)
class PreviewLog:
    """Preview at the right front wheel at k times, float32.

    time_s: (k,). distance_m: (n,) ahead of the wheel. height_m, position_sigma_m, existence: (k, n), see
    `RoadPreview`.
    """

    time_s: NDArray[np.float32]
    distance_m: NDArray[np.float32]
    height_m: NDArray[np.float32]
    position_sigma_m: NDArray[np.float32]
    existence: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.time_s)


def decimated(preview: RoadPreview, wheel: int) -> tuple[float, np.ndarray, np.ndarray]:
    """Preview of one wheel every 0.1 m: (time_s, distances, [height, position_sigma, existence])."""
    stride = max(1, round(STEP_M / float(preview.distance_m[1] - preview.distance_m[0])))
    rows = (preview.height_m, preview.position_sigma_m, preview.existence)
    sampled = np.array([row[wheel, ::stride] for row in rows], np.float32)
    return preview.time_s, preview.distance_m[::stride], sampled


def collect(records: Sequence[tuple[float, np.ndarray, np.ndarray]]) -> PreviewLog:
    """Combine decimated previews into one log, which may be empty."""
    if not records:
        none = np.zeros((0, 0), np.float32)
        return PreviewLog(none[:, 0:0].ravel(), none.ravel(), none, none, none)
    times, distances, rows = zip(*records, strict=True)
    height, sigma, existence = np.stack(rows, axis=1)
    return PreviewLog(np.array(times, np.float32), distances[0].astype(np.float32), height, sigma, existence)
