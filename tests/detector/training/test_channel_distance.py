"""Channel-wise distance by hand, against batch norms and automatic differentiation, and in parts."""

import math

import pytest

pytest.importorskip("torch")

import torch
from torch import nn
from torch.nn.functional import kl_div

from foreride.detector.training import channel_distance as module
from foreride.detector.training.channel_distance import channel_distance


def by_modules(student: torch.Tensor, teacher: torch.Tensor, temperature: float) -> torch.Tensor:
    """The same by batch norms, softmax and divergence, differentiated automatically."""
    norms = [nn.BatchNorm2d(maps.shape[1], affine=False).to(maps.dtype) for maps in (student, teacher)]
    q, p = (
        (norm(maps).flatten(2) / temperature).log_softmax(2)
        for norm, maps in zip(norms, (student, teacher), strict=True)
    )
    total = kl_div(q, p, reduction="sum", log_target=True)
    return total * temperature**2 / (student.shape[0] * student.shape[1])


@pytest.mark.parametrize(("temperature", "level"), [(1.0, 0.0), (2.0, 7.0)])
def test_distance_of_two_positions_by_hand(temperature: float, level: float) -> None:
    """Unit variance: the teacher says e^(1/t) : e^(-1/t), a student without contrast one to one."""
    teacher = torch.tensor([1.0, -1.0], dtype=torch.double).reshape(1, 1, 1, 2)
    p = 1 / (1 + math.exp(-2 / temperature))
    by_hand = temperature**2 * (p * math.log(2 * p) + (1 - p) * math.log(2 * (1 - p)))
    found = channel_distance(torch.zeros_like(teacher), teacher + level, temperature)
    assert found.item() == pytest.approx(by_hand, rel=1e-4)  # of the variance, 1e-5 is added
    several = [maps.expand(2, 5, 1, 2) for maps in (torch.zeros_like(teacher), teacher)]
    assert channel_distance(*several, temperature).item() == pytest.approx(by_hand, rel=1e-4)


def test_distance_of_a_map_to_itself_is_none_whatever_its_level_and_scale() -> None:
    maps = torch.randn(2, 3, 4, 5, dtype=torch.double)
    assert channel_distance(maps, 5 * maps - 2).item() == pytest.approx(0.0, abs=1e-6)
    assert channel_distance(maps, maps.flip(3)).item() > 0.1


@pytest.mark.parametrize("chunk", [1, 300, 1 << 20])
@pytest.mark.parametrize("order", [torch.contiguous_format, torch.channels_last])
@pytest.mark.parametrize("temperature", [1.0, 2.5])
def test_distance_and_gradient_are_those_of_modules(
    monkeypatch: pytest.MonkeyPatch, chunk: int, order: torch.memory_format, temperature: float
) -> None:
    monkeypatch.setattr(module, "_CPU_CHUNK", chunk)
    random = torch.Generator().manual_seed(7)
    student, teacher = torch.randn(2, 3, 5, 6, 7, dtype=torch.double, generator=random)
    student = (3 * student + 1).to(memory_format=order).requires_grad_()
    found, expected = (call(student, 2 * teacher - 4, temperature) for call in (channel_distance, by_modules))
    assert found.item() == pytest.approx(expected.item(), rel=1e-12)
    gradients = [torch.autograd.grad(3 * one, student)[0] for one in (found, expected)]
    torch.testing.assert_close(*gradients, rtol=1e-9, atol=1e-15)


def test_half_precision_stays_near_single_precision() -> None:
    student, teacher = torch.randn(2, 4, 8, 6, 7, generator=torch.Generator().manual_seed(3))
    rough = student.bfloat16().requires_grad_()
    found = channel_distance(rough, teacher.bfloat16())
    found.backward()
    exact = student.requires_grad_()
    channel_distance(exact, teacher).backward()
    assert found.dtype == torch.float32
    assert rough.grad is not None
    assert rough.grad.dtype == torch.bfloat16
    torch.testing.assert_close(
        rough.grad.float(), exact.grad, rtol=0.1, atol=0.02 * exact.grad.abs().max().item()
    )
