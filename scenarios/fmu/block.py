"""Block: a part of the closed loop with named, dimensioned inputs and outputs, as an FMU shows it."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from foreride.files.errors import InputError
from foreride.scenarios.definition.clock import TICKS_PER_SECOND


@dataclass(frozen=True)
class Port:
    """Port: name, direction, unit (of `files.fmi.units`), description and, for an input, its start value."""

    name: str
    causality: Literal["input", "output"]
    unit: str
    description: str
    start: float = 0.0


class Block(Protocol):
    """Protocol of a block, which advances in ticks of 1 ms.

    step_s: communication step that suits it; duration_s: of the scenario's drive.
    """

    step_s: float
    duration_s: float
    ports: tuple[Port, ...]
    inputs: dict[str, float]

    def reset(self) -> None:
        """Return to time zero with the present inputs."""

    def advance(self, ticks: int) -> None:
        """Advance by whole ticks; inputs are those at the beginning."""

    def outputs(self) -> dict[str, float]:
        """Outputs at the present time."""

    def state(self) -> dict[str, Any]:
        """Internal state as plain numbers and lists; empty where it cannot be saved."""

    def restore(self, state: dict[str, Any]) -> None:
        """Continue from a state saved before."""


def start_values(ports: Iterable[Port]) -> dict[str, float]:
    """Start values of the inputs among ports."""
    return {port.name: port.start for port in ports if port.causality == "input"}


def whole_ticks(step_s: float) -> int:
    """Ticks in a communication step. Raises InputError unless the step is a multiple of 1 ms."""
    ticks = step_s * TICKS_PER_SECOND
    if not (0.5 < ticks < 1e9 and abs(ticks - round(ticks)) < 1e-6 * ticks):
        raise InputError(f"communication step must be a multiple of 0.001 s, got {step_s:g} s")
    return round(ticks)
