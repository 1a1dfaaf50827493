"""The one exception that means: the input is wrong, not the program."""


class InputError(ValueError):
    """Bad input, told in one line that names file, field, value and what is allowed."""
