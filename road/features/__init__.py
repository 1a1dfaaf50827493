"""Discrete obstacles of a road: bumps, humps, potholes, joints, covers, steps, and rows of them."""
