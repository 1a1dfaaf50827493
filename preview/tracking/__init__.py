"""Multi-object tracking of bumps and potholes by non-linear least squares over their boxes."""
