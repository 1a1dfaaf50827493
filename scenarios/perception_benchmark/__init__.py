"""Perception benchmark: seeded roads with many obstacles, and the estimator's errors on them."""
