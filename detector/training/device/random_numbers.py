"""Random numbers on a device as a function of a seed."""

import numpy as np
import torch
from torch import Tensor


class Random:
    """Source of random tensors on a device: the same seeds on the same device give the same numbers."""

    def __init__(self, device: torch.device, *seeds: int):
        self.generator = torch.Generator(device)
        self.generator.manual_seed(int(np.random.SeedSequence(seeds).generate_state(1, np.uint64)[0] >> 1))
        self.device = device

    def uniform(self, *shape: int) -> Tensor:
        """Uniform numbers in 0..1."""
        return torch.rand(shape, generator=self.generator, device=self.device)

    def normal(self, *shape: int) -> Tensor:
        """Normal numbers of mean 0 and variance 1."""
        return torch.randn(shape, generator=self.generator, device=self.device)

    def log_normal(self, sigma: float, *shape: int) -> Tensor:
        """Factors whose logarithm is normal."""
        return (sigma * self.normal(*shape)).exp()

    def chosen(self, count: int, share: float) -> Tensor:
        """(count,) bool: true with a probability of `share`."""
        return self.uniform(count) < share
