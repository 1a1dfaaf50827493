"""Shared by all tests: hypothesis judges results, not how long a busy machine took for them."""

from hypothesis import settings

settings.register_profile("foreride", deadline=None)
settings.load_profile("foreride")
