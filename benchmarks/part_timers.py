"""CPU time by parts of a program: named functions are wrapped while a measurement lasts.

Each second counts once, for the innermost of the wrapped functions that run. Pools of threads run their work
at once in the calling thread meanwhile, so that the process's CPU time belongs to the function that runs;
threads inside libraries count where they are called.
"""

import importlib
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from functools import wraps
from time import process_time
from typing import Any
from unittest.mock import patch

OTHER = "other"


class PartTimers:
    """Stopwatch of parts: `seconds` and `calls` by part, and of what no part contains under `OTHER`."""

    def __init__(self) -> None:
        self.seconds: defaultdict[str, float] = defaultdict(float)
        self.calls: Counter[str] = Counter()
        self._running = OTHER
        self._since = process_time()

    def switch(self, part: str) -> str:
        """Count the time until now for the part that runs, and go on with this one; return the former."""
        now, former = process_time(), self._running
        self.seconds[former] += now - self._since
        self._running, self._since = part, now
        return former

    def timed(self, part: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, whose time counts for the part."""

        @wraps(function)
        def run(*arguments: Any, **options: Any) -> Any:
            former = self.switch(part)
            self.calls[part] += 1
            try:
                return function(*arguments, **options)
            finally:
                self.switch(former)

        return run


@contextmanager
def measured(parts: Mapping[str, Sequence[str]]) -> Iterator[PartTimers]:
    """Measure the parts, each given by its functions as `package.module:function` or `:Class.method`."""
    with ExitStack() as patches:
        timers = PartTimers()
        patches.enter_context(patch.object(ThreadPoolExecutor, "submit", _run_at_once))
        for part, names in parts.items():
            for name in names:
                for owner, attribute, function in places(name):
                    patches.enter_context(patch.object(owner, attribute, _wrapped(timers, part, function)))
        timers.switch(OTHER)
        timers.seconds.clear()
        yield timers
        timers.switch(OTHER)


def places(name: str) -> list[tuple[Any, str, Any]]:
    """Objects that hold the named function under an attribute, with that attribute and the function.

    A method has one place, a function one in each module that imports it. Raises AttributeError or
    ImportError for a name that does not exist.
    """
    module_name, _, path = name.partition(":")
    owner: Any = importlib.import_module(module_name)
    *outer, attribute = path.split(".")
    for part in outer:
        owner = getattr(owner, part)
    if outer:
        return [(owner, attribute, vars(owner)[attribute])]
    function = getattr(owner, attribute)
    modules = [module for key, module in sys.modules.items() if key.partition(".")[0] == "foreride"]
    return [(module, attribute, function) for module in modules if vars(module).get(attribute) is function]


def _wrapped(timers: PartTimers, part: str, function: Any) -> Any:
    if isinstance(function, property) and function.fget is not None:
        return property(timers.timed(part, function.fget), function.fset)
    return timers.timed(part, function)


def _run_at_once(_: ThreadPoolExecutor, work: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
    """Replacement of `ThreadPoolExecutor.submit` that is done when it returns."""
    future: Future[Any] = Future()
    try:
        future.set_result(work(*arguments, **options))
    except BaseException as error:
        future.set_exception(error)
    return future
