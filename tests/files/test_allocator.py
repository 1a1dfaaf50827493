"""Test of the heap that threads share: arenas as glibc itself counts them."""

import ctypes
import re
import subprocess
import sys

CODE = """
import ctypes, threading
from foreride.files.allocator import share_heap
share_heap()
barrier = threading.Barrier(4)
def work():
    kept = [bytes(100_000) for _ in range(10)]
    barrier.wait()
threads = [threading.Thread(target=work) for _ in range(4)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
libc = ctypes.CDLL(None)
if hasattr(libc, "malloc_stats"):
    libc.malloc_stats()
"""


def test_threads_have_no_heap_of_their_own() -> None:
    told = subprocess.run([sys.executable, "-c", CODE], check=True, capture_output=True, text=True).stderr
    arenas = re.findall(r"^Arena \d+:", told, re.MULTILINE)
    assert len(arenas) == (1 if hasattr(ctypes.CDLL(None), "malloc_stats") else 0)
