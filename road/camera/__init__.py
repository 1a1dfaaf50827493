"""Pinhole camera: intrinsics, mounting, lens distortion, projection and calibration."""
