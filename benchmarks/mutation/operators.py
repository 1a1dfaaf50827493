"""Mutation operators on Python's syntax tree.

They are the classical ones of mutation analysis (Offutt et al., An experimental determination of sufficient
mutant operators, ACM TOSEM 5(2), 1996): replacement of arithmetic, relational and logical operators, of signs
and of constants. Annotations, docstrings, raised messages and assertions, of which `zip(..., strict=True)` is
one, are left as they are.
"""

import ast
from collections.abc import Iterator
from copy import copy

ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.MatMult: ast.Mult,
}
RELATIONAL: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
SIGNS: dict[type[ast.unaryop], type[ast.unaryop]] = {ast.USub: ast.UAdd, ast.UAdd: ast.USub}


UNTOUCHED = ("annotation", "returns", "type_params", "decorator_list")
"""Fields of syntax nodes whose content is not executed where the function runs."""


def replacement(node: ast.AST) -> ast.AST | None:
    """Mutated copy of a node; None for a node that no operator fits."""
    changed = copy(node)
    if (
        isinstance(changed, ast.BinOp | ast.AugAssign)
        and type(changed.op) in ARITHMETIC
        and not _is_text(node)
    ):
        changed.op = ARITHMETIC[type(changed.op)]()
    elif isinstance(changed, ast.Compare) and type(changed.ops[0]) in RELATIONAL:
        changed.ops = [RELATIONAL[type(changed.ops[0])](), *changed.ops[1:]]
    elif isinstance(changed, ast.BoolOp):
        changed.op = ast.Or() if isinstance(changed.op, ast.And) else ast.And()
    elif isinstance(changed, ast.UnaryOp) and type(changed.op) in SIGNS:
        changed.op = SIGNS[type(changed.op)]()
    elif isinstance(changed, ast.Constant) and isinstance(changed.value, bool | int | float):
        changed.value = _other_constant(changed.value)
    else:
        return None
    return changed


def _other_constant(value: float) -> float:
    """Constant that replaces one: the opposite, the next integer, twice the number or one for zero."""
    if isinstance(value, bool):
        return not value
    return value + 1 if isinstance(value, int) else 2 * value or 1.0


def _is_text(node: ast.AST) -> bool:
    """Whether an operation joins or formats text or lists; the other operator is an error of types there."""
    sides = (node.left, node.right) if isinstance(node, ast.BinOp) else ()
    return any(
        isinstance(side, ast.JoinedStr | ast.List | ast.Tuple)
        or (isinstance(side, ast.Constant) and isinstance(side.value, str))
        for side in sides
    )


def _is_skipped(node: ast.AST) -> bool:
    """Whether nothing below a node is mutated: raised messages, assertions, declared types and ranges."""
    annotated = isinstance(node, ast.Subscript) and ast.unparse(node.value) == "Annotated"
    strict = isinstance(node, ast.keyword) and node.arg == "strict"
    return annotated or strict or isinstance(node, ast.Raise | ast.Assert)


def mutations(tree: ast.AST) -> Iterator[tuple[ast.AST, str, int | None, ast.AST]]:
    """Every mutation below a node as parent, field, place in the field's list and new node, in text order."""
    for field, value in ast.iter_fields(tree):
        if field in UNTOUCHED:
            continue
        for place, child in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if isinstance(child, ast.AST) and not _is_skipped(child):
                if (new := replacement(child)) is not None:
                    yield tree, field, place, new
                yield from mutations(child)


def mutated(text: str, number: int) -> tuple[str, int, str]:
    """A source text with its mutation of that number made, the line and the change in words."""
    tree = ast.parse(text)
    parent, field, place, new = list(mutations(tree))[number]
    holder = getattr(parent, field)
    old = holder if place is None else holder[place]
    words = f"{ast.unparse(old)} -> {ast.unparse(new)}"
    if place is None:
        setattr(parent, field, new)
    else:
        holder[place] = new
    return ast.unparse(tree) + "\n", getattr(old, "lineno", 0), words
