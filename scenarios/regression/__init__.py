"""Regression tests of ride metrics: baselines and tolerances."""
