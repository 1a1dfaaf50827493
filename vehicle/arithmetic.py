"""Arithmetics in which the equations are evaluated: NumPy, CasADi, or lists of floats (`FLOATS`)."""

import math
from types import ModuleType, SimpleNamespace

FLOATS = SimpleNamespace(fmax=max, fmin=min, tanh=math.tanh, fabs=abs, exp=math.exp, sqrt=math.sqrt)
"""The functions of floats that forces may use; NumPy and CasADi have them under the same names."""
Arithmetic = ModuleType | SimpleNamespace
