"""Auxiliary classes: they share the head while a network is trained, and no file of weights holds them.

To be told what a crossing, a patch or a cover is keeps a network from taking it for a bump or a pothole.
"""

import torch
from torch import Tensor, nn

from foreride.detector.network.models import Network
from foreride.road.obstacle_classes import AUXILIARY_NAMES, CLASS_NAMES

OBSTACLES = len(CLASS_NAMES)
ALL_CLASSES = OBSTACLES + len(AUXILIARY_NAMES)
_BRANCH = "head.label."


def resized(weights: dict[str, Tensor], model: nn.Module) -> dict[str, Tensor]:
    """Weights with as many classes as `model`: surplus ones are dropped, missing ones as in `model`."""
    own = model.state_dict()
    return {
        name: _resized(value, own[name]) if _is_branch(name, own) else value
        for name, value in weights.items()
    }


def _is_branch(name: str, own: dict[str, Tensor]) -> bool:
    return name.startswith(_BRANCH) and name in own


def _resized(value: Tensor, own: Tensor) -> Tensor:
    """Rows of one class branch; `value` itself where it is not that of a network with these classes."""
    counts = {OBSTACLES, ALL_CLASSES}
    if not {len(value), len(own)} <= counts or value.shape[1:] != own.shape[1:]:
        return value
    kept = min(len(value), len(own))
    return torch.cat((value[:kept], own[kept:].to(value)))


def obstacles_only(model: Network) -> Network:
    """The network without its auxiliary classes, in inference mode; the scores of the others are the same."""
    narrow = Network(model.layout).to(next(model.parameters()).device)
    narrow.load_state_dict(resized(model.state_dict(), narrow))
    return narrow.eval().requires_grad_(False)
