"""Parameter studies: axes, sweeps on Dask, resumable results, and tuning."""
