"""Random drives with wrong previews: their roads, maps and settings, drawn by number."""
