"""Plant tick: the integration interval of the simulation, 1 ms."""

RATE_HZ = 1000  # ticks per second
STEP_S = 1 / RATE_HZ
