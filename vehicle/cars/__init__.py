"""Parameter sets of the quarter, half and full car."""
