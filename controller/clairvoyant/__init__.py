"""Clairvoyant bound: the optimal plan for a whole drive whose road is known."""
