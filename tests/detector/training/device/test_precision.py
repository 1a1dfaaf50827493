"""The precision of a training follows the instructions that the device has."""

import json
from pathlib import Path

import pytest

pytest.importorskip("torch")
import torch

from foreride.detector.training.device.precision import BF16_INSTRUCTIONS, fastest_precision
from foreride.detector.training.train import main
from tests.detector.roads import write


@pytest.mark.parametrize("having", BF16_INSTRUCTIONS)
def test_a_processor_with_instructions_for_bfloat16_uses_them(
    monkeypatch: pytest.MonkeyPatch, having: str
) -> None:
    monkeypatch.setattr(torch.cpu, "get_capabilities", lambda: {"avx2": True, having: True})
    assert fastest_precision("cpu") == "bf16"


def test_a_processor_without_them_does_not_emulate_them(monkeypatch: pytest.MonkeyPatch) -> None:
    known = {"avx2": True, "avx512_f": True, "avx512_bf16": False, "amx_bf16": False}
    monkeypatch.setattr(torch.cpu, "get_capabilities", lambda: known)
    assert fastest_precision("cpu") == "fp32"


def test_the_instructions_are_named_as_torch_names_them() -> None:
    known = torch.cpu.get_capabilities()
    names = {"x86_64": {"avx512_bf16", "amx_bf16"}, "aarch64": {"bf16"}, "arm64": {"bf16"}}
    assert names.get(known["architecture"], set()) <= known.keys() & set(BF16_INSTRUCTIONS)


@pytest.mark.parametrize(("native", "precision"), [(True, "bf16"), (False, "fp32")])
def test_a_gpu_likewise(monkeypatch: pytest.MonkeyPatch, native: bool, precision: str) -> None:
    def supported(including_emulation: bool) -> bool:
        assert not including_emulation
        return native

    monkeypatch.setattr(torch.cuda, "is_bf16_supported", supported)
    assert fastest_precision("cuda") == precision


@pytest.mark.parametrize(
    ("asked", "used"), [([], fastest_precision("cpu")), (["--precision", "bf16"], "bf16")]
)
def test_the_run_records_the_precision_it_computed_in(tmp_path: Path, asked: list[str], used: str) -> None:
    write(tmp_path / "data" / "train", 2, 0)
    write(tmp_path / "data" / "val", 1, 1)
    words = ["--data", str(tmp_path / "data"), "--out", str(tmp_path / "run"), "--stages", "64x64:2"]
    assert main([*words, "--batch", "2", "--threads", "1", *asked]) == 0
    settings = json.loads((tmp_path / "run" / "config.json").read_text())["settings"]
    assert settings["precision"] == used
