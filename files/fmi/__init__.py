"""Functional mock-up units of other tools (FMI 2.0 and 3.0, co-simulation), run in a process of their own."""
