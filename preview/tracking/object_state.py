"""Indices of the state of a tracked object."""

X, OFFSET, GROUND, LENGTH, HEIGHT, EDGE_BIAS = range(6)
"""Near edge (m), pitch offset (rad), ground height (m), length (m), height or depth (m), edge bias (rad).

For the equations see `preview.tracking.gauss_newton`.
"""
