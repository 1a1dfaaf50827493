"""Result tables over the reporting set, one command each."""
