"""Blended weights: the ends are the two files, scores shift by logits, and other models are refused."""

from pathlib import Path

import pytest

pytest.importorskip("torch")

import torch

from foreride.detector.network.auxiliary import ALL_CLASSES
from foreride.detector.network.checkpoint import load_network, save, save_weights
from foreride.detector.network.models import build
from foreride.detector.training.blend import blend, main
from foreride.detector.training.options import SHIPPED
from foreride.files.errors import InputError

IMAGE = torch.rand(1, 3, 64, 96, generator=torch.Generator().manual_seed(0))


@pytest.fixture(scope="module")
def after(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Checkpoint of a network with auxiliary classes, whose weights differ a little from the shipped ones."""
    model = build("sbp-yolo", ALL_CLASSES)
    generator = torch.Generator().manual_seed(1)
    state = model.state_dict()
    for name, value in load_network(SHIPPED)[0].state_dict().items():
        if value.is_floating_point():
            changed = value * (1 + 0.01 * torch.randn(value.shape, generator=generator))
            state[name][: len(value)] = changed
    path = tmp_path_factory.mktemp("blend") / "checkpoint.pt"
    content = {"model": state, "average": state, "optimiser": {}, "passes": 7, "model_name": "sbp-yolo"}
    save(path, content)
    return path


def _scores(path_or_network: object) -> torch.Tensor:
    network = load_network(path_or_network)[0] if isinstance(path_or_network, Path) else path_or_network
    with torch.no_grad():
        return network(IMAGE).class_logits  # type: ignore[operator]


def test_the_ends_are_the_two_files(after: Path) -> None:
    assert torch.equal(_scores(blend(SHIPPED, after, 0.0)[0]), _scores(SHIPPED))
    assert torch.equal(_scores(blend(SHIPPED, after, 1.0)[0]), _scores(after))
    assert not torch.equal(_scores(SHIPPED), _scores(after))


def test_each_weight_is_the_weighted_mean(after: Path) -> None:
    mixed = blend(SHIPPED, after, 0.25)[0].state_dict()
    first, second = load_network(SHIPPED)[0].state_dict(), load_network(after)[0].state_dict()
    for name, value in mixed.items():
        if value.is_floating_point():
            torch.testing.assert_close(value, 0.75 * first[name] + 0.25 * second[name])


def test_a_shift_moves_the_logits_alone(after: Path) -> None:
    shifted, plain = (blend(SHIPPED, after, 0.3, shift)[0] for shift in (-0.2, 0.0))
    torch.testing.assert_close(_scores(shifted), _scores(plain) - 0.2, atol=1e-4, rtol=0)


def test_the_command_writes_weights_that_can_be_used(after: Path, tmp_path: Path) -> None:
    out = tmp_path / "blended.pt"
    assert main(["shipped", str(after), "--share", "0.3", "--out", str(out)]) == 0
    network, metadata = load_network(out)
    torch.testing.assert_close(_scores(network), _scores(blend(SHIPPED, after, 0.3)[0]), atol=0.05, rtol=0.01)
    assert metadata["passes"] == 7
    assert metadata["calibration"] == load_network(SHIPPED)[1]["calibration"]
    assert metadata["stages"].endswith("blended in by a share of 0.3")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--share", "1.5"], "--share"),
        (["--share", "nan"], "--share"),
        (["--score-shift", "9"], "--score-shift"),
    ],
)
def test_numbers_out_of_range_are_refused(
    words: list[str], told: str, after: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "blended.pt"
    assert main(["shipped", str(after), *words, "--out", str(out)]) == 2
    assert told in capsys.readouterr().err
    assert not out.exists()


def test_another_model_is_refused(tmp_path: Path) -> None:
    other = tmp_path / "other.pt"
    save_weights(other, build("yolo11n"), {"model": "yolo11n"})
    with pytest.raises(InputError, match=r"other\.pt: must be of the same model as .*sbp-yolo.*yolo11n"):
        blend(SHIPPED, other, 0.5)
