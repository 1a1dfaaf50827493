"""Scenarios, closed-loop simulation, and the studies, reports and commands built on them."""
