"""Where a graph can run: onnxruntime on the CPU, or an accelerator whose package the user has installed."""

from dataclasses import dataclass
from pathlib import Path

import onnxruntime as ort

from files.errors import InputError


@dataclass(frozen=True)
class Backend:
    """An execution provider of onnxruntime and the package that brings it."""

    provider: str
    package: str


BACKENDS = {
    "cpu": Backend("CPUExecutionProvider", "onnxruntime"),
    "openvino": Backend("OpenVINOExecutionProvider", "onnxruntime-openvino"),
    "cuda": Backend("CUDAExecutionProvider", "onnxruntime-gpu"),
    "tensorrt": Backend("TensorrtExecutionProvider", "onnxruntime-gpu with TensorRT"),
}


def installed() -> list[str]:
    """Names of the backends that can be used here."""
    providers = set(ort.get_available_providers())
    return [name for name, backend in BACKENDS.items() if backend.provider in providers]


def open_session(
    path: Path, backend: str = "cpu", threads: int = 1, size: tuple[int, int] | None = None
) -> ort.InferenceSession:
    """A session on an ONNX file, made for images of size (width, height), or of any size where it is None.

    A known size lets onnxruntime fold what depends on it and fuse sums into convolutions. Its threads do not
    spin between images, so idle cores stay free. Raises InputError where the backend is not installed or the
    file is no ONNX model that can be run.
    """
    if backend not in BACKENDS:
        raise InputError(f"backend must be one of {', '.join(BACKENDS)}, got {backend!r}")
    if backend not in installed():
        package = BACKENDS[backend].package
        raise InputError(
            f"backend {backend}: not installed, needs {package}; installed: {', '.join(installed())}"
        )
    options = ort.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    options.log_severity_level = 4
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    if size is None:
        options.graph_optimization_level = ort.GraphOptimizationLevel.ORT_DISABLE_ALL
    else:
        options.add_free_dimension_override_by_name("width", size[0])
        options.add_free_dimension_override_by_name("height", size[1])
    providers = list(dict.fromkeys((BACKENDS[backend].provider, "CPUExecutionProvider")))
    try:
        return ort.InferenceSession(path, options, providers=providers)
    except Exception as error:  # onnxruntime raises a dozen kinds, none of them documented
        raise InputError(f"{path}: not an ONNX model that can be run ({type(error).__name__})") from None
