"""Reading of data files: bounded, strict, and with one-line errors."""
