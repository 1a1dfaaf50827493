"""Signals of a drive, computed from its recorded states a part at a time or all at once.

All signals at every tick take several times the memory of the states from which they follow, so that those
who go through a drive once, such as its metrics and its file, take them in parts.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.state import VehicleState

Array = NDArray[np.float64]
PART_TICKS = 30_000


class RecordedSignals(Mapping[str, Array]):
    """Signals that a plant has recorded, one value per tick under each name, as `flat_signals` names them.

    The first access to a name computes them all.
    """

    def __init__(self, plant: Plant) -> None:
        """The plant must not be driven any further."""
        self._plant, self._ticks = plant, plant.recorded_ticks
        self._last: tuple[int, VehicleState] | None = None

    def parts(self) -> Iterator[VehicleState]:
        """Signals of `PART_TICKS` ticks after the other."""
        for first in range(0, self._ticks, PART_TICKS):
            if self._last is None or self._last[0] != first:  # a short drive is computed once
                self._last = None
                self._last = first, self._plant.between(first, min(first + PART_TICKS, self._ticks))
            yield self._last[1]

    def whole(
        self, chosen: Callable[[VehicleState], Mapping[str, Array]], ticks: NDArray[np.int64] | None = None
    ) -> dict[str, Array]:
        """What `chosen` makes of each part, arrays (..., n), over the drive or at ascending `ticks` alone."""
        count = self._ticks if ticks is None else len(ticks)
        found: dict[str, Array] = {}
        first = 0
        for part in self.parts():
            last = first + len(part.time_s)
            own: slice | NDArray[np.int64] = slice(None)
            here = slice(first, last)
            if ticks is not None:
                here = slice(*np.searchsorted(ticks, (first, last)).tolist())
                own = ticks[here] - first
            for name, values in chosen(part).items():
                if name not in found:
                    found[name] = np.empty((*values.shape[:-1], count))
                found[name][..., here] = values[..., own]
            first = last
        return found

    @cached_property
    def _columns(self) -> dict[str, Array]:
        return self.whole(flat_signals)

    def __getitem__(self, name: str) -> Array:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (self._columns,)


def flat_signals(record: VehicleState) -> dict[str, Array]:
    """Signals as one array of length n per name; rows of per-wheel and per-seat signals get their index."""
    flat: dict[str, Array] = {}
    for field in fields(record):
        values = np.asarray(getattr(record, field.name), dtype=float)
        if values.ndim == 1:
            flat[field.name] = values
        elif field.name != "x":
            flat |= {f"{field.name}_{index}": row for index, row in enumerate(values)}
    return flat
