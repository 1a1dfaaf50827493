"""Channel-wise distance of feature maps (CWD: Shu et al., ICCV 2021), with its gradient in closed form.

Each channel of a map, divided by its standard deviation over the batch, is a distribution over positions,
p = softmax(t / (σ_t τ)) for the teacher, q for the student. Distance: τ²/(B·C) Σ KL(p ‖ q). On a CPU the
images are gone through a few at a time, so that intermediate results stay in the processor's cache.
"""

from collections.abc import Iterator
from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

_EPSILON = 1e-5  # added to the variance of a channel, as in a batch norm
_CPU_CHUNK = 1 << 20  # elements gone through at a time


def channel_distance(student: Tensor, teacher: Tensor, temperature: float = 1.0) -> Tensor:
    """Channel-wise distance of two maps (B, C, H, W), differentiable by the student."""
    distance: Tensor = _ChannelDistance.apply(student, teacher, temperature)
    return distance


class _ChannelDistance(torch.autograd.Function):
    """Distance; its gradient is computed with it, and kept in the student's precision."""

    @staticmethod
    def forward(ctx: Any, student: Tensor, teacher: Tensor, temperature: float) -> Tensor:
        mean, student_scale = _moments(student)
        _, teacher_scale = _moments(teacher)
        factor = temperature**2 / (student.shape[0] * student.shape[1])
        gradient = torch.empty_like(student, memory_format=torch.channels_last)
        distance, along = mean.new_zeros(()), torch.zeros_like(mean)
        for part in _parts(student):
            z = _rows(student[part]) * (student_scale / temperature)
            log_p = (_rows(teacher[part]) * (teacher_scale / temperature)).log_softmax(1)
            log_q, p = z.log_softmax(1), log_p.exp()
            distance += factor * (p.flatten() @ log_p.sub_(log_q).flatten())
            by_z = log_q.exp_().sub_(p).mul_(factor)
            along += z.mul_(by_z).sum((0, 1))
            gradient[part] = _maps(by_z, student[part])
        # z also depends on the student by the standard deviation of its channels.
        by_offset = along * student_scale**2 / (student.numel() // student.shape[1])
        for part in _parts(student):
            by_deviation = (_rows(student[part]) - mean).mul_(by_offset)
            by_student = (_rows(gradient[part]) * (student_scale / temperature)).sub_(by_deviation)
            gradient[part] = _maps(by_student, student[part])
        ctx.save_for_backward(gradient)
        return distance

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *outer: Tensor) -> tuple[Tensor, None, None]:
        (gradient,) = ctx.saved_tensors
        return gradient * outer[0].to(gradient.dtype), None, None


def _moments(maps: Tensor) -> tuple[Tensor, Tensor]:
    """Mean and inverse standard deviation (C,) of each channel."""
    count = maps.numel() // maps.shape[1]
    dtype = torch.promote_types(maps.dtype, torch.float32)
    sums = [_rows(maps[part]).sum((0, 1), dtype=dtype) for part in _parts(maps)]
    mean = torch.stack(sums).sum(0) / count
    squares = [(_rows(maps[part]) - mean).square_().sum((0, 1)) for part in _parts(maps)]
    return mean, (torch.stack(squares).sum(0) / count + _EPSILON).rsqrt()


def _parts(maps: Tensor) -> Iterator[slice]:
    """Parts of a batch: all of it on a GPU."""
    count = len(maps) if maps.is_cuda else max(1, _CPU_CHUNK // maps[0].numel())
    return (slice(first, first + count) for first in range(0, len(maps), count))


def _rows(maps: Tensor) -> Tensor:
    """Maps as (B, H·W, C), which is their order in memory if that is channels-last."""
    return maps.permute(0, 2, 3, 1).flatten(1, 2)


def _maps(rows: Tensor, like: Tensor) -> Tensor:
    """The inverse of `_rows`."""
    batch, channels, height, width = like.shape
    return rows.view(batch, height, width, channels).permute(0, 3, 1, 2)
