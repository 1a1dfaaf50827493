"""Scenarios and the closed loop: the thin top of foreride."""
