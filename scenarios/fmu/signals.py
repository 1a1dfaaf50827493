"""Output ports for the signals of the car."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from foreride.scenarios.fmu.block import Port
from foreride.vehicle.state import VehicleState, signal_unit

ECHOES = (
    "time_s",
    "x_m",
    "speed_m_s",
    "forward_acc",
    "command",
    "force_command",
    "road_height",
    "road_velocity",
)
"""Signals that are time or inputs of the car."""

METRIC_PORTS = (
    Port("wk_rms", "output", "m/s²", "Wk-weighted RMS acceleration so far, all seats (ISO 2631-1)"),
    Port("tyre_load_rms", "output", "1", "RMS relative dynamic tyre load so far, all wheels"),
    Port("rattle_rms", "output", "m", "RMS suspension travel so far, all wheels"),
    Port("objective", "output", "m²/s⁴", "J = wk_rms² + rho · tyre_load_rms² so far"),
)


def values_now(state: VehicleState) -> dict[str, float]:
    """Signals of one instant by their names in `signals.parquet`."""
    values: dict[str, float] = {}
    for field in fields(state):
        signal = np.asarray(getattr(state, field.name), dtype=float)
        if signal.ndim == 0:
            values[field.name] = float(signal)
        elif field.name != "x":
            values |= {f"{field.name}_{index}": float(value) for index, value in enumerate(signal)}
    return values


def signal_ports(state: VehicleState, left_out: Sequence[str] = ECHOES) -> tuple[Port, ...]:
    """Output ports of a car's signals, without those whose name begins with one left out."""
    return tuple(
        Port(name, "output", signal_unit(name), f"{name.replace('_', ' ')}, as in signals.parquet")
        for name in values_now(state)
        if not name.startswith(tuple(left_out))
    )
