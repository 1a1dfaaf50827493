"""Commands that drive cases: demo, run, compare, sweep, regress, bound and tune."""
