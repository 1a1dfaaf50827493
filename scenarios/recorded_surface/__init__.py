"""Recorded road surfaces: point clouds or stereo pairs of a data set to previews, without a simulator."""
