"""Simulation clock in integer plant ticks, so that rates never drift or depend on rounding."""

TICKS_PER_SECOND = 1000
"""Plant tick rate, 1 kHz."""


def due(tick: int, rate_hz: int) -> bool:
    """Whether a process of `rate_hz` (1 ... 1000 Hz) fires at `tick`.

    Firing k falls on the first tick at or after k/rate, also for rates that do not divide 1000
    (30 Hz fires at ticks 0, 34, 67, 100, ...).
    """
    return tick == 0 or (tick * rate_hz) // TICKS_PER_SECOND != ((tick - 1) * rate_hz) // TICKS_PER_SECOND


def next_due(tick: int, rate_hz: int) -> int:
    """First tick after `tick` at which a process of `rate_hz` fires."""
    fired = tick * rate_hz // TICKS_PER_SECOND
    return -(-(fired + 1) * TICKS_PER_SECOND // rate_hz)


def ticks(duration_s: float) -> int:
    """Duration in seconds, rounded to ticks."""
    return round(duration_s * TICKS_PER_SECOND)
