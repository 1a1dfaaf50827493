"""Random streams of a drive: independent generators by name, so that a new one never shifts another."""

import numpy as np

_NUMBERED = ("sensors", "boxes", "mounting", "image", "oracle", "faults", "map")


def random_stream(seed: int, name: str) -> np.random.Generator:
    """Generator of the stream `name` at its beginning.

    The numbered streams are the children of the seed in that order; any other is keyed by its name.
    """
    key = (_NUMBERED.index(name),) if name in _NUMBERED else tuple(name.encode())
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))
