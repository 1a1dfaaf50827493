"""Common test configuration: hypothesis without deadlines, which a busy machine would miss."""

from hypothesis import settings

settings.register_profile("foreride", deadline=None)
settings.load_profile("foreride")
