"""Training schedule: image sizes by stage, and the learning rate over the passes."""

import math
import re
from dataclasses import dataclass

from foreride.files.errors import InputError


@dataclass(frozen=True)
class Stage:
    """Training stage: `passes` image passes at `width` x `height` pixels."""

    width: int
    height: int
    passes: int

    def __str__(self) -> str:
        return f"{self.width}x{self.height}:{self.passes}"


def parse_stages(text: str) -> tuple[Stage, ...]:
    """Stages from text such as `320x192:60000,640x384:15000`. Raises InputError."""
    stages = []
    for part in text.split(","):
        match = re.fullmatch(r"(\d+)x(\d+):(\d+)", part.strip())
        if not match:
            raise InputError(f"--stages: must be WIDTHxHEIGHT:PASSES[,...], got {part.strip()!r}")
        width, height, passes = map(int, match.groups())
        if width % 32 or height % 32 or not width or not height or not passes:
            raise InputError(
                f"--stages: width and height must be multiples of 32, passes > 0, got {part.strip()!r}"
            )
        stages.append(Stage(width, height, passes))
    return tuple(stages)


def stage_at(stages: tuple[Stage, ...], passes: int) -> Stage:
    """Current stage after so many passes; the last one when all are done."""
    for stage in stages:
        passes -= stage.passes
        if passes < 0:
            return stage
    return stages[-1]


def total_passes(stages: tuple[Stage, ...]) -> int:
    """Number of image passes of all stages."""
    return sum(stage.passes for stage in stages)


def work_done(stages: tuple[Stage, ...], passes: int) -> float:
    """Share 0..1 of all pixels processed after so many passes."""
    processed = total = 0
    for stage in stages:
        pixels = stage.width * stage.height
        total += pixels * stage.passes
        processed += pixels * min(max(passes, 0), stage.passes)
        passes -= stage.passes
    return processed / total


DECAYS = {"linear": lambda done: 1 - done, "cosine": lambda done: (1 + math.cos(math.pi * done)) / 2}
"""Decay factor of the learning rate when a share 0..1 of the work is done."""


def rate_factor(
    stages: tuple[Stage, ...], passes: int, warmup: int, decay: str = "linear", floor: float = 0.01
) -> float:
    """Learning rate over its peak: linear warm-up, then decay with the pixels processed.

    The warm-up takes `warmup` passes, or a tenth of all if these are fewer, as in a short fine-tuning.
    """
    rise = min(1.0, (passes + 1) / max(min(warmup, total_passes(stages) // 10), 1))
    return rise * (floor + (1 - floor) * DECAYS[decay](work_done(stages, passes)))
