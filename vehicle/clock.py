"""The plant's tick."""

RATE_HZ = 1000  # ticks a second
STEP_S = 1 / RATE_HZ
