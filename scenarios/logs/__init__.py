"""Logs: runs in the formats of measurement tools, and recordings that are played through the perception."""
