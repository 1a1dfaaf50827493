"""Tyre-road contact: the effective road height under a wheel."""
