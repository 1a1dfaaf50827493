"""File input and output shared by all packages: strict reading, atomic writing, caching."""
