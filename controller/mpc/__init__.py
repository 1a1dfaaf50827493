"""Model predictive control: linearisation, quadratic program and constraints of a plan."""
