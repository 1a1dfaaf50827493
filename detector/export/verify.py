"""Numerical parity of an ONNX graph with torch."""

import copy
from collections.abc import Callable, Sequence

import numpy as np
import onnx
import onnxruntime as ort
import torch

from foreride.detector.network.deployed import Deployed
from foreride.detector.network.models import Network


def parity(model: Network, graph: onnx.ModelProto, images: Sequence[np.ndarray]) -> float:
    """Largest difference between ONNX and torch: of a score, or of a box side over the image width."""
    deployed = Deployed(copy.deepcopy(model).eval())

    def by_torch(image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        with torch.inference_mode():
            boxes, scores = deployed(torch.from_numpy(image)[None])
        return boxes[0].numpy(), scores[0].numpy()

    by_onnx = runner(graph)
    return max((difference(by_torch(i), by_onnx(i), i.shape[1]) for i in images), default=0.0)


def runner(graph: onnx.ModelProto) -> Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """Function from an image to the graph's boxes and scores, on one thread."""
    options = ort.SessionOptions()
    options.intra_op_num_threads = 1
    session = ort.InferenceSession(graph.SerializeToString(), options, providers=["CPUExecutionProvider"])

    def run(image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        boxes, scores = session.run(None, {"image": image[None]})
        return boxes[0], scores[0]

    return run


def difference(
    result: tuple[np.ndarray, np.ndarray], reference: tuple[np.ndarray, np.ndarray], width: int
) -> float:
    """Largest difference of a score or of a box side over the image width.

    Each of the first result's 100 best candidates is compared with the nearest candidate of the other,
    since rounding may swap candidates of nearly equal score.
    """
    result_rows, reference_rows = _candidates(*result, width)[:100], _candidates(*reference, width)
    return float(np.abs(result_rows[:, None] - reference_rows[None]).max(2).min(1).max())


def _candidates(boxes: np.ndarray, scores: np.ndarray, width: int) -> np.ndarray:
    """Rows of box over image width, and scores, best first."""
    order = np.argsort(-scores.max(1), kind="stable")
    return np.concatenate((boxes / width, scores), 1)[order]
