"""Scenario files: schema, loading, overrides, sets and cases."""
