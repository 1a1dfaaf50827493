"""Inference backends: onnxruntime on the CPU, and optional faster runtimes."""

import importlib.util
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import onnxruntime as ort
from numpy.typing import NDArray

from foreride.files.errors import InputError

ort.disable_telemetry_events()  # some builds send usage data to the vendor

Run = Callable[[NDArray[np.uint8]], tuple[NDArray[np.float32], NDArray[np.float32]]]
"""Image (H, W, 3) uint8 → boxes (1, K, 4) in pixels and scores (1, K, classes): raw network output."""


@dataclass(frozen=True)
class Backend:
    """Inference backend: its package and configuration.

    provider: execution provider of onnxruntime, empty for OpenVINO. arithmetic: precision of OpenVINO
    """

    package: str
    provider: str = ""
    arithmetic: str = ""


CPU = "cpu"
"""Backend of the base installation, with which every published number was computed."""
BACKENDS = {
    CPU: Backend("onnxruntime", "CPUExecutionProvider"),
    "openvino": Backend("openvino", arithmetic="f32"),
    "openvino-bf16": Backend("openvino", arithmetic="bf16"),
    "cuda": Backend("onnxruntime-gpu", "CUDAExecutionProvider"),
    "tensorrt": Backend("onnxruntime-gpu with TensorRT", "TensorrtExecutionProvider"),
}


def installed() -> list[str]:
    """Names of the backends whose packages are installed."""
    providers = set(ort.get_available_providers())
    return [
        name
        for name, backend in BACKENDS.items()
        if (backend.provider in providers if backend.provider else importlib.util.find_spec(backend.package))
    ]


def computes_bf16() -> bool:
    """Whether OpenVINO is installed and this processor has instructions for bfloat16."""
    if not importlib.util.find_spec("openvino"):
        return False
    import openvino

    return "BF16" in openvino.Core().get_property("CPU", "OPTIMIZATION_CAPABILITIES")


def require(name: str) -> Backend:
    """Backend by name. Raises InputError if it is unknown or its package is not installed."""
    if name not in BACKENDS:
        raise InputError(f"backend must be one of {', '.join(BACKENDS)}, got {name!r}")
    if name not in installed():
        package, available = BACKENDS[name].package, ", ".join(installed())
        raise InputError(f"backend {name}: not installed, needs {package}; installed: {available}")
    return BACKENDS[name]


def open_network(path: Path, backend: str, threads: int, size: tuple[int, int]) -> Run:
    """Open the network of an ONNX file for images of one size (width, height).

    Raises InputError if the backend is not installed or the file is no ONNX model that it can run.
    """
    chosen = require(backend)
    if not chosen.provider:
        return _open_openvino(path, chosen.arithmetic, threads, size)
    session = open_session(path, chosen.provider, threads, size)

    def run(image: NDArray[np.uint8]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        try:
            boxes, scores = session.run(["boxes", "scores"], {"image": image[None]})
        except Exception as error:  # the exception types of onnxruntime are undocumented
            raise _failed(path, image, f"onnxruntime {ort.__version__}", error) from None
        return boxes, scores

    return run


def open_session(
    path: Path,
    provider: str = "CPUExecutionProvider",
    threads: int = 1,
    size: tuple[int, int] | None = None,
) -> ort.InferenceSession:
    """Open an onnxruntime session on an ONNX file for images of size (width, height), None for any.

    A known size lets onnxruntime fold what depends on it and fuse sums into convolutions. Its threads do not
    spin between images, so idle cores stay free. Raises InputError if the file is no ONNX model that can be
    run.
    """
    options = ort.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    options.log_severity_level = 4
    options.enable_mem_reuse = False  # its buffer plan costs 7 % of the time, and 20 MiB
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    if size is None:
        options.graph_optimization_level = ort.GraphOptimizationLevel.ORT_DISABLE_ALL
    else:
        options.add_free_dimension_override_by_name("width", size[0])
        options.add_free_dimension_override_by_name("height", size[1])
    providers = list(dict.fromkeys((provider, "CPUExecutionProvider")))
    try:
        return ort.InferenceSession(path, options, providers=providers)
    except Exception as error:  # onnxruntime raises a dozen undocumented exception types
        kind = type(error).__name__
        raise InputError(
            f"{path}: not an ONNX model that onnxruntime {ort.__version__} can run ({kind})"
        ) from None


def _open_openvino(path: Path, arithmetic: str, threads: int, size: tuple[int, int]) -> Run:
    import openvino

    from foreride.detector.openvino_model import read_model

    config = {
        "INFERENCE_NUM_THREADS": threads,
        "NUM_STREAMS": 1,
        "INFERENCE_PRECISION_HINT": arithmetic,
        "PERFORMANCE_HINT": "LATENCY",
    }
    try:
        request = openvino.Core().compile_model(read_model(path, size), "CPU", config).create_infer_request()
    except RuntimeError as error:
        raise InputError(
            f"{path}: not an ONNX model that OpenVINO can run ({type(error).__name__})"
        ) from None
    one_at_a_time = threading.Lock()

    def run(image: NDArray[np.uint8]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        with one_at_a_time:
            try:
                outputs = request.infer({"image": image[None]})
            except RuntimeError as error:
                raise _failed(path, image, "OpenVINO", error) from None
            return outputs["boxes"].copy(), outputs["scores"].copy()

    return run


def _failed(path: Path, image: NDArray[np.uint8], runtime: str, error: Exception) -> InputError:
    size = f"{image.shape[1]} x {image.shape[0]}"
    return InputError(f"{path}: {runtime} cannot run it on an image of {size} px ({type(error).__name__})")
