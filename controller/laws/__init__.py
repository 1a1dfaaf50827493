"""Reactive control laws: passive, skyhook family, power-driven damping, clipped LQR."""
