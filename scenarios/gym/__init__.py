"""Gymnasium environment of damper control."""
