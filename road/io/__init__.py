"""Readers of road surface files: CSV profiles and ASAM OpenCRG."""
