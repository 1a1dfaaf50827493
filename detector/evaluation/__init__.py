"""Detection metrics: average precision, results by object and condition, plots and contact sheets."""
