"""Distance on the ground from image rows."""
