"""Training checkpoints to resume from, and weights files in half precision."""

import copy
import io
from pathlib import Path
from typing import Any, Generic, TypeVar

import torch
from torch import Tensor, nn

from foreride.detector.calibration import read_calibration
from foreride.detector.detections import CLASS_NAMES
from foreride.detector.network.auxiliary import resized
from foreride.detector.network.models import Network, build
from foreride.files.errors import InputError, shown
from foreride.files.reading.regular_file import read_bytes
from foreride.files.writing.atomic import write_bytes

M = TypeVar("M", bound=nn.Module)
CHECKPOINT_LIMIT = 2 << 30
"""Maximum size of a checkpoint: 2 GiB."""
DEFAULT_MODEL = "sbp-yolo"  # of files without a model name


class Average(Generic[M]):
    """Exponential moving average of a model's parameters and buffers.

    The decay grows from 0 to `decay` over the first `ramp` steps, so that initial values are forgotten.
    """

    def __init__(self, model: M, decay: float = 0.999, ramp: int = 500):
        self.model = copy.deepcopy(model).eval().requires_grad_(False)
        self.decay, self.ramp = decay, ramp

    def update(self, model: nn.Module, step: int) -> None:
        """Update the average with a model after training step number `step`."""
        share = 1 - self.decay * (1 - 0.5 ** (step / self.ramp))
        with torch.no_grad():
            for mean, value in zip(_tensors(self.model), _tensors(model), strict=True):
                if mean.is_floating_point():
                    mean.lerp_(value, share)
                else:
                    mean.copy_(value)


def _tensors(model: nn.Module) -> list[Tensor]:
    return list(model.state_dict().values())


def save(path: Path, content: dict[str, Any]) -> None:
    """Write a dictionary of tensors and plain values atomically."""
    stream = io.BytesIO()
    torch.save(content, stream)
    write_bytes(path, stream.getvalue())


def load(path: Path, keys: tuple[str, ...]) -> dict[str, Any]:
    """Read what `save` wrote, tensors and plain values only, at most CHECKPOINT_LIMIT bytes.

    Raises InputError where the file is absent, broken or of another kind.
    """
    if not path.exists():
        raise InputError(f"{path}: no such file; must be a file written by foreride.detector.training.train")
    data = read_bytes(path, CHECKPOINT_LIMIT)
    try:
        content = torch.load(io.BytesIO(data), map_location="cpu", weights_only=True)
    except Exception as error:
        raise InputError(f"{path}: not a readable torch file ({type(error).__name__})") from None
    if not isinstance(content, dict) or any(key not in content for key in keys):
        raise InputError(f"{path}: must have the entries {', '.join(keys)}")
    return content


def save_weights(path: Path, model: nn.Module, metadata: dict[str, Any]) -> None:
    """Write a model's weights in half precision, with metadata of the training."""
    state = {k: v.half() if v.is_floating_point() else v for k, v in model.state_dict().items()}
    save(path, {"weights": state, "metadata": metadata})


def load_weights(path: Path, model: nn.Module) -> dict[str, Any]:
    """Load a weights file, or the average of a checkpoint, into a model; returns the metadata.

    The model may have auxiliary classes, which files of weights lack and checkpoints may have.
    Raises InputError if it does not fit.
    """
    weights, metadata = _weights_of(path)
    try:
        model.load_state_dict(resized(weights, model))
    except (RuntimeError, TypeError, ValueError, AttributeError):
        model_name = metadata.get("model", DEFAULT_MODEL)
        raise InputError(
            f"{path}: weights of model {model_name} do not fit a model of another kind"
        ) from None
    return metadata


def load_network(path: Path) -> tuple[Network, dict[str, Any]]:
    """Network in inference mode, and metadata, of a weights file. Raises InputError."""
    name = str(_weights_of(path)[1].get("model", DEFAULT_MODEL))
    model = build(name)
    return model.eval(), load_weights(path, model)


def _weights_of(path: Path) -> tuple[dict[str, Tensor], dict[str, Any]]:
    content = load(path, ())
    if "average" in content:
        checkpoint_metadata = {
            "passes": content.get("passes", 0),
            "model": content.get("model_name", DEFAULT_MODEL),
        }
        content = {"weights": content["average"], "metadata": checkpoint_metadata}
    if "weights" not in content or "metadata" not in content:
        raise InputError(f"{path}: must have the entries weights, metadata")
    weights, metadata = content["weights"], content["metadata"]
    if not isinstance(metadata, dict):
        raise InputError(f"{path}: metadata must be a mapping of named values, got {shown(metadata)}")
    names = metadata.get("names", list(CLASS_NAMES))
    if names != list(CLASS_NAMES):
        raise InputError(f"{path}: classes must be {', '.join(CLASS_NAMES)}, got {shown(names)}")
    read_calibration(metadata, str(path))
    check_weights(weights, str(path))
    return weights, metadata


def check_weights(weights: Any, source: str) -> None:
    """Raise InputError unless these are named tensors of finite numbers."""
    if not isinstance(weights, dict) or not all(isinstance(value, Tensor) for value in weights.values()):
        raise InputError(f"{source}: weights must be named tensors, got {type(weights).__name__}")
    for name, value in weights.items():
        if value.is_floating_point() and not bool(torch.isfinite(value).all()):
            raise InputError(f"{source}: weights must be finite, {shown(name)} holds NaN or infinity")
