"""Run folders: written whole, read back and verified."""
