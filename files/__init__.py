"""Strict reading and atomic writing, shared by every package."""
