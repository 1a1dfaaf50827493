"""Fallback supervisor: checks of sensors, answers and previews, and the statistics of its steps."""
