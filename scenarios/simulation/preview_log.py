"""Preview record of a run: the previews given to the controller, decimated."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from foreride.preview.road_preview import RoadPreview

RATE_HZ = 20
STEP_M = 0.1


@dataclass(frozen=True)
class PreviewLog:
    """Preview at the right front wheel at k times, n distances each, float32; see `RoadPreview`."""

    time_s: Annotated[
        NDArray[np.float32], "s", "moment at which the preview is anchored to the wheels"
    ]  # (k,)
    distance_m: Annotated[NDArray[np.float32], "m", "distances ahead of the right front wheel"]  # (n,)
    height_m: Annotated[NDArray[np.float32], "m", "expected road height at these distances"]
    position_sigma_m: Annotated[NDArray[np.float32], "m", "standard deviation of the position"]
    existence: Annotated[NDArray[np.float32], "1", "probability that what is there exists"]

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
