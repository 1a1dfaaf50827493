"""Roads, cars and speeds drawn from a stated distribution, for claims that no chosen event can support."""
