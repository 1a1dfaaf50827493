"""Perceptions: the ways in which a controller comes to know the road ahead."""
