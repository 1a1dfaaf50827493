"""Elevation map: range measurements of LiDAR or stereo camera, fused to the heights ahead of each wheel."""
