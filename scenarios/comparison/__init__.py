"""Comparison of controllers: statistics over seeds, and tables."""
