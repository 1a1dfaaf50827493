"""Film of a passive and a preview car side by side."""
