"""Car as an FMU in plain C, generated from the equations of motion, which needs no Python to run."""
