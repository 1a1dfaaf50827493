"""File input and output shared by all packages: strict reading, atomic writing, caching."""

import foreride.files.compiled  # noqa: F401 - before any library looks for its cache
