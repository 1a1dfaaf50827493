"""Road surface, tyre enveloping, camera model and renderer: the environment of the vehicle.

ISO 8855 axes: x forward along the road, y left, z up; the road starts at x = 0, the lane centre is y = 0.
"""
