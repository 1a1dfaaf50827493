"""Clairvoyant bound of a case: cached optimum, and the headroom over the passive car."""
