"""Dampers and actuators: ideal, valve map, magnetorheological, slow-active and fully active."""
