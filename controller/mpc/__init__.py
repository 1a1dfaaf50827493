"""Model predictive control: prediction model, condensing, quadratic program and constraints."""
