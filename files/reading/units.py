"""Units that files and hand-written numbers are likely to use instead of the SI unit of a field."""

from collections.abc import Callable

LENGTHS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001, "um": 1e-6, "in": 0.0254, "ft": 0.3048, "km": 1000.0}
"""Length units of files by name, in metres."""
_LIKELY: dict[str, dict[str, float]] = {
    "m": {"mm": 1e-3, "cm": 1e-2, "in": 0.0254},
    "kg": {"t": 1e3, "g": 1e-3},
    "N/m": {"N/mm": 1e3},
    "N/m²": {"N/mm²": 1e6},
    "N/m³": {"N/mm³": 1e9},
    "N·s/m": {"N·s/mm": 1e3},
    "N": {"kN": 1e3},
    "s": {"ms": 1e-3},
    "m/s": {"mm/s": 1e-3, "km/h": 1 / 3.6},
    "A": {"mA": 1e-3},
}
"""Likely units by the SI unit of a field, likeliest first, as factors to it."""


def unit_hint(value: float, unit: str, fits: Callable[[float], bool]) -> str:
    """Hint at the likely unit in which a refused value would fit, to append to a message; "" if none."""
    for name, factor in _LIKELY.get(unit, {}).items():
        if fits(value * factor):
            return f"; in {name} it would be {float(f'{value * factor:.4g}'):.10g} {unit}"
    return ""
