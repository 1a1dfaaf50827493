"""Writing of files and folders: atomic, locked, marked, and never over the user's own."""
