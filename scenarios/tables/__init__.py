"""Result tables of README and documentation, one command each: `foreride table`."""
