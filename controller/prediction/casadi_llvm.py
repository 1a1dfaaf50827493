"""CasADi-to-LLVM compiler: the instruction list of an SX function, translated to LLVM and compiled.

CasADi interprets its instructions one by one; here each becomes an LLVM instruction, for one point or for
several side by side in the processor's vector registers. Nothing is reordered or contracted, so the results
equal CasADi's bit for bit. The compiler is llvmlite, which Numba installs; the object code is cached.
"""

import ctypes
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import casadi
import llvmlite
import llvmlite.binding as llvm
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from foreride.files.jit import njit
from foreride.files.object_code import object_code
from foreride.files.stamp import module_stamp

llvm.initialize_native_target()
llvm.initialize_native_asmprinter()

_OPERATIONS = {
    casadi.OP_ASSIGN: "fadd {t} {a}, {zero}",
    casadi.OP_ADD: "fadd {t} {a}, {b}",
    casadi.OP_SUB: "fsub {t} {a}, {b}",
    casadi.OP_MUL: "fmul {t} {a}, {b}",
    casadi.OP_DIV: "fdiv {t} {a}, {b}",
    casadi.OP_NEG: "fneg {t} {a}",
    casadi.OP_SQ: "fmul {t} {a}, {a}",
    casadi.OP_TWICE: "fadd {t} {a}, {a}",
    casadi.OP_INV: "fdiv {t} {one}, {a}",
    casadi.OP_FMIN: "call {t} @llvm.minnum.{s}({t} {a}, {t} {b})",
    casadi.OP_FMAX: "call {t} @llvm.maxnum.{s}({t} {a}, {t} {b})",
    casadi.OP_FABS: "call {t} @llvm.fabs.{s}({t} {a})",
    casadi.OP_SQRT: "call {t} @llvm.sqrt.{s}({t} {a})",
    casadi.OP_EXP: "call {t} @llvm.exp.{s}({t} {a})",
    casadi.OP_LOG: "call {t} @llvm.log.{s}({t} {a})",
    casadi.OP_TANH: "call {t} @llvm.tanh.{s}({t} {a})",
}
_COMPARISONS = {
    casadi.OP_LT: "fcmp olt {t} {a}, {b}",
    casadi.OP_LE: "fcmp ole {t} {a}, {b}",
    casadi.OP_EQ: "fcmp oeq {t} {a}, {b}",
    casadi.OP_NE: "fcmp une {t} {a}, {b}",
    casadi.OP_NOT: "fcmp oeq {t} {a}, {zero}",
    casadi.OP_IF_ELSE_ZERO: "fcmp une {t} {a}, {zero}",
}
_SIGNATURE = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 2, *[ctypes.c_int64] * 3)


class CompiledFunction:
    """SX function compiled for evaluation over the columns of an array, one point per column.

    The rows of `points` are the inputs, one argument below the other, nonzeros in CasADi's column order; the
    rows of `results` are the outputs likewise. With one lane, a point may read what the previous point wrote.
    Raises NotImplementedError for an unsupported operation.
    address: of the machine code, for `evaluate`; it is valid as long as this object lives.
    """

    def __init__(self, function: casadi.Function, lanes: int = 1):
        engine = _loaded(function, lanes)
        self.address = engine.get_function_address("kernel")
        self._run = _SIGNATURE(self.address)
        self._run.engine = engine  # type: ignore[attr-defined]  # keep the owner of the code alive
        self.lanes = lanes
        self.rows_in = sum(function.nnz_in(i) for i in range(function.n_in()))
        self.rows_out = sum(function.nnz_out(i) for i in range(function.n_out()))

    def __call__(self, points: np.ndarray, results: np.ndarray, count: int) -> None:
        """Evaluate the first `count` columns of `points` (rows_in, n) into `results` (rows_out, n), float64.

        count: a multiple of the lanes. Both may be views of one array. Raises ValueError for arrays that do
        not fit.
        """
        self.bind(points, results, count)()

    def bind(self, points: np.ndarray, results: np.ndarray, count: int) -> Callable[[], None]:
        """Return a callable that repeats this evaluation; both arrays must be kept alive by the caller."""
        self._check("points", points, self.rows_in, count)
        self._check("results", results, self.rows_out, count)
        lengths = points.strides[0] // 8, results.strides[0] // 8
        return partial(self._run, points.ctypes.data, results.ctypes.data, count, *lengths)

    def _check(self, name: str, array: np.ndarray, rows: int, count: int) -> None:
        sufficient = array.ndim == 2 and array.shape[0] >= rows and array.shape[1] >= count
        if not (sufficient and array.dtype == np.float64 and array.strides[1] == 8):
            raise ValueError(f"{name} must be float64 of at least ({rows}, {count}), got {array.shape}")
        if count % self.lanes:
            raise ValueError(f"count must be a multiple of {self.lanes}, got {count}")


def _loaded(function: casadi.Function, lanes: int) -> llvm.ExecutionEngine:
    """Owner of the executable code of a function, whose object code comes from the cache if it is there."""
    processor = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    # One level halves the run time or better; more would only take longer to compile.
    machine = llvm.Target.from_default_triple().create_target_machine(*processor, opt=1)
    versions = casadi.CasadiMeta.version(), llvmlite.__version__, llvm.llvm_version_info
    told = repr((lanes, machine.triple, processor, versions)).encode()
    code = object_code(
        (module_stamp(__name__), told, function.serialize().encode()),
        lambda: machine.emit_object(llvm.parse_assembly(_module(function, lanes))),
    )
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine


def _kernel_call(
    _: Any, address: Any, points: Any, results: Any, count: Any, row_in: Any, row_out: Any
) -> Any:
    """Numba's code for the call of a kernel by its address."""

    def code(_: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, number = ir.IntType(8).as_pointer(), ir.IntType(64)
        kernel = ir.FunctionType(ir.VoidType(), [pointer] * 2 + [number] * 3).as_pointer()
        arrays = [builder.inttoptr(array, pointer) for array in arguments[1:3]]
        builder.call(builder.inttoptr(arguments[0], kernel), arrays + list(arguments[3:]))

    return types.none(*[types.int64] * 6), code


_call: Any = intrinsic(_kernel_call)


@njit
def evaluate(address: int, points: Any, results: Any, count: int) -> None:
    """The same evaluation by its address, for functions that Numba compiles; the arrays are not checked."""
    rows = points.strides[0] // 8, results.strides[0] // 8
    _call(address, points.ctypes.data, results.ctypes.data, count, *rows)


def _module(function: casadi.Function, lanes: int) -> str:
    """LLVM assembly of `kernel(points, results, count, row length of points, row length of results)`."""
    number, suffix = ("double", "f64") if lanes == 1 else (f"<{lanes} x double>", f"v{lanes}f64")
    body = "\n".join(f"  {line}" for line in _body(function, lanes, number, suffix))
    intrinsics = {"minnum": 2, "maxnum": 2, "fabs": 1, "sqrt": 1, "exp": 1, "log": 1, "tanh": 1}
    declared = "\n".join(
        f"declare {number} @llvm.{name}.{suffix}({', '.join([number] * arguments)})"
        for name, arguments in intrinsics.items()
    )
    return f"""
{declared}
define void @kernel(ptr %points, ptr %results, i64 %count, i64 %in, i64 %out)
    "min-legal-vector-width"="{64 * lanes}" {{
start:
  br label %point
point:
  %at = phi i64 [0, %start], [%next, %point]
{body}
  %next = add i64 %at, {lanes}
  %more = icmp slt i64 %next, %count
  br i1 %more, label %point, label %done
done:
  ret void
}}
"""


def _body(function: casadi.Function, lanes: int, number: str, suffix: str) -> Iterator[str]:
    """LLVM instructions for each of CasADi's; `values` maps the slots of its work vector to LLVM values."""
    values: dict[int, str] = {}
    flag = "i1" if lanes == 1 else f"<{lanes} x i1>"
    symbols = {"t": number, "s": suffix, "zero": _constant(0.0, lanes), "one": _constant(1.0, lanes)}
    first_in = np.cumsum([0, *(function.nnz_in(i) for i in range(function.n_in()))])
    first_out = np.cumsum([0, *(function.nnz_out(i) for i in range(function.n_out()))])
    for k in range(function.n_instructions()):
        op, source, target = (
            function.instruction_id(k),
            function.instruction_input(k),
            function.instruction_output(k),
        )
        if op == casadi.OP_OUTPUT:
            yield from _address(k, "results", "out", first_out[target[0]] + target[1])
            yield f"store {number} {values[source[0]]}, ptr %p{k}, align 8"
        elif op == casadi.OP_INPUT:
            yield from _address(k, "points", "in", first_in[source[0]] + source[1])
            yield f"%v{k} = load {number}, ptr %p{k}, align 8"
            values[target[0]] = f"%v{k}"
        elif op == casadi.OP_CONST:
            values[target[0]] = _constant(function.instruction_constant(k), lanes)
        else:
            operands = dict(zip("ab", (values[i] for i in source), strict=False))
            if op in _COMPARISONS:
                yield f"%c{k} = " + _COMPARISONS[op].format(**symbols, **operands)
                chosen = operands["b"] if op == casadi.OP_IF_ELSE_ZERO else symbols["one"]
                yield f"%v{k} = select {flag} %c{k}, {number} {chosen}, {number} {symbols['zero']}"
            elif op in _OPERATIONS:
                yield f"%v{k} = " + _OPERATIONS[op].format(**symbols, **operands)
            else:
                raise NotImplementedError(f"CasADi operation {op} of {function.name()} has no translation")
            values[target[0]] = f"%v{k}"


def _address(k: int, array: str, row_length: str, row: int) -> Iterator[str]:
    yield f"%r{k} = mul i64 {row}, %{row_length}"
    yield f"%e{k} = add i64 %r{k}, %at"
    yield f"%p{k} = getelementptr double, ptr %{array}, i64 %e{k}"


def _constant(value: float, lanes: int) -> str:
    """LLVM literal of a double, written exactly as hexadecimal bits."""
    bits = f"0x{np.float64(value).view(np.uint64):016X}"
    return bits if lanes == 1 else "<" + ", ".join([f"double {bits}"] * lanes) + ">"
