"""ONNX export against torch, at sizes other than the traced one."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")
pytest.importorskip("onnx")
import onnx
import torch

from foreride.detector.export.to_onnx import export, fused, main, to_onnx
from foreride.detector.export.verify import parity
from foreride.detector.network.checkpoint import load_weights, save_weights
from foreride.detector.network.models import Network
from foreride.detector.runtime import WEIGHTS, Detector
from foreride.files.errors import InputError

SHIPPED = WEIGHTS.with_suffix(".pt")


def smooth(height: int, width: int) -> np.ndarray:
    ramp = np.add.outer(np.arange(height), np.arange(width))[..., None] + [0, 40, 90]
    return (127 + 120 * np.sin(ramp / 15)).astype(np.uint8)


def test_folding_the_norms_changes_nothing() -> None:
    model = Network()
    load_weights(SHIPPED, model)
    model.eval()
    x = torch.from_numpy(smooth(64, 96)).permute(2, 0, 1)[None] / 255
    with torch.no_grad():
        assert torch.allclose(fused(model)(x).class_logits, model(x).class_logits, atol=1e-3)
    assert not any(isinstance(m, torch.nn.BatchNorm2d) for m in fused(model).modules())


def test_export_agrees_with_torch_at_every_size(tmp_path: Path) -> None:
    images = [smooth(h, w) for h, w in ((384, 640), (192, 320), (96, 96))]
    out = tmp_path / "model.onnx"
    metadata = export(SHIPPED, out, "1.2.3", images)
    assert metadata["version"] == "1.2.3"
    assert Detector(out).metadata == metadata
    model = Network()
    load_weights(SHIPPED, model)
    assert parity(model, onnx.load(out), images) <= 1e-4


def test_disagreement_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    untrained = Network().eval()
    monkeypatch.setattr(
        "foreride.detector.export.to_onnx.to_onnx",
        lambda model, *rest, **how: to_onnx(untrained, *rest, **how),
    )
    out = tmp_path / "model.onnx"
    out.write_text("old")
    with pytest.raises(InputError, match="ONNX and torch differ"):
        export(SHIPPED, out, "0", [smooth(96, 96)])
    assert out.read_text() == "old"


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["--weights", str(tmp_path / "none.pt"), "--out", str(tmp_path / "x.onnx")]) == 2
    assert "none.pt: no such file" in capsys.readouterr().err
    weights = tmp_path / "w.pt"
    model = Network()
    load_weights(SHIPPED, model)
    save_weights(weights, model, {"passes": 7, "dataset": "abc"})
    assert main(["--weights", str(weights), "--out", str(tmp_path / "x.onnx")]) == 0
    assert Detector(tmp_path / "x.onnx").metadata["passes"] == "7"
