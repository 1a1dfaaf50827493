"""Closed-loop simulation of one case: multi-rate loop, faults, wheel profiles, worker processes."""
