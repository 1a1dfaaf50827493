"""Logs: runs in the formats of robotics and measurement tools."""
