"""Files of torch: what is no set of finite weights is refused by name."""

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("torch")
import torch

from foreride.detector.network.checkpoint import load_weights, save, save_weights
from foreride.files.errors import InputError


def model() -> Any:
    torch.manual_seed(0)
    return torch.nn.Linear(2, 2)


def refusal(path: Path) -> str:
    with pytest.raises(InputError, match=path.name) as caught:
        load_weights(path, model())
    return str(caught.value)


def test_weights_and_metadata_come_back(tmp_path: Path) -> None:
    save_weights(tmp_path / "w.pt", model(), {"model": "linear"})
    other = model()
    other.weight.data.zero_()
    assert load_weights(tmp_path / "w.pt", other) == {"model": "linear"}
    assert torch.allclose(other.weight, model().weight, atol=1e-3)


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_weights_that_are_not_finite_are_refused(tmp_path: Path, value: float) -> None:
    broken = model()
    broken.bias.data[1] = value
    save_weights(tmp_path / "w.pt", broken, {})
    assert "weights must be finite, 'bias' holds NaN or infinity" in refusal(tmp_path / "w.pt")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ([1, 2], "must have the entries"),
        ({"weights": {}, "metadata": 5}, "metadata must be a mapping of named values, got 5"),
        (
            {"weights": {}, "metadata": {"names": "pothole"}},
            "classes must be speed_bump, pothole, got 'pothole'",
        ),
        ({"weights": {}, "metadata": {"names": 3}}, "classes must be speed_bump, pothole, got 3"),
        ({"weights": [1], "metadata": {}}, "weights must be named tensors, got list"),
        ({"weights": {"bias": 1.0}, "metadata": {}}, "weights must be named tensors"),
        ({"weights": {}, "metadata": {}}, "do not fit a model of another kind"),
        ({"average": None}, "weights must be named tensors, got NoneType"),
    ],
)
def test_content_of_another_shape_is_refused(tmp_path: Path, content: Any, message: str) -> None:
    save(tmp_path / "w.pt", content)
    assert message in refusal(tmp_path / "w.pt")
