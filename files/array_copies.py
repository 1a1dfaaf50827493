"""Copies between arrays of one shape in compiled functions, element by element.

An assignment of an array to a slice, `target[:] = source`, makes Numba compile the text of the error for other
shapes, too: some 2 500 lines of LLVM for each function with one, against 150 for these loops.
"""

from typing import Any

from foreride.files.jit import njit


@njit
def copy_vector(source: Any, target: Any) -> None:
    """Copy the entries (n,) of one array into another."""
    for i in range(len(target)):
        target[i] = source[i]


@njit
def copy_matrix(source: Any, target: Any) -> None:
    """Copy the entries (m, n) of one array into another."""
    for i in range(target.shape[0]):
        for j in range(target.shape[1]):
            target[i, j] = source[i, j]
