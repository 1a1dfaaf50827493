"""Imported modules are kept out of the collector's searches, and nothing else is."""

import subprocess
import sys

PROGRAM = """
import gc
from foreride.files.collector import import_unsearched, unsearched
started = []
gc.callbacks.append(lambda phase, info: started.append(phase))
with unsearched():
    kept = [[] for _ in range(100_000)]
assert not started and gc.isenabled()
count = gc.get_freeze_count()
assert count >= 100_000
class Node: pass
import weakref
node = Node()
node.own, gone = node, weakref.ref(node)
with unsearched():
    del node
import_unsearched("json")
assert gc.get_freeze_count() == count, "frozen twice"
assert gc.collect() and gone() is None, "garbage made later is not collected"
"""
OFF = """
import gc
from foreride.files.collector import unsearched
gc.disable()
with unsearched():
    pass
assert not gc.isenabled() and not gc.get_freeze_count()
"""
FAILED = """
import gc
from foreride.files.collector import unsearched
try:
    with unsearched():
        raise SystemExit(3)
except SystemExit:
    assert gc.isenabled()
"""


def test_objects_are_frozen_once_and_the_collector_goes_on() -> None:
    for program in (PROGRAM, OFF, FAILED):
        subprocess.run([sys.executable, "-c", program], check=True)
