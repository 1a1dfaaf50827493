"""Simulated range measurements: rays cast on the true road."""
