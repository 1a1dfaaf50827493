"""Exit codes of the commands in this folder: 0, or 2 after invalid input, which is reported in one line."""

import sys
from collections.abc import Callable, Sequence
from functools import wraps

from foreride.files.errors import InputError


def command(run: Callable[[Sequence[str] | None], object]) -> Callable[..., int]:
    """Wrap a `main` to return its exit code."""

    @wraps(run)
    def main(arguments: Sequence[str] | None = None) -> int:
        try:
            run(arguments)
        except InputError as error:
            print(f"error: {error}", file=sys.stderr)
            return 2
        return 0

    return main
