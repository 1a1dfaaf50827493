"""Layers of the ground map: pavement, markings, obstacles, damage and deposits."""
