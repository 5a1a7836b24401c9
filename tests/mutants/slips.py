"""The slips: sign, order, term, factor, bound, axis; each as text that replaces an expression."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

ONE_PERCENT = "one percent more"

Slip = tuple[int, int, str, str]
"""From byte, to byte, both from the expression's begin; what stands there then; what it is."""

COMPARED = {
    ast.Lt: ("<", "<=", ">"),
    ast.LtE: ("<=", "<", ">"),
    ast.Gt: (">", ">=", "<"),
    ast.GtE: (">=", ">", "<"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
}
COMPUTED = {ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*")}
SWAPPED = {"cross", "arctan2", "atan2", "subtract", "divide", "outer", "matmul", "where"}
EXCHANGED = {
    "sin": "cos",
    "cos": "sin",
    "minimum": "maximum",
    "maximum": "minimum",
    "min": "max",
    "max": "min",
    "floor": "ceil",
    "ceil": "floor",
    "any": "all",
    "all": "any",
    "argmin": "argmax",
    "argmax": "argmin",
    "deg2rad": "rad2deg",
    "radians": "degrees",
    "degrees": "radians",
    "mean": "sum",
    "sum": "mean",
    "median": "mean",
}
DROPPED = {"abs", "sqrt", "square", "clip", "conj", "exp", "radians", "deg2rad", "flip", "cumsum"}
"""Functions of which only the first argument is left."""
TURNED = {"inverse", "inv", "transpose", "conj"}
"""Methods left away."""
PLACES = ("folder", "path", "root", "place", "file", "out", "home")
"""A slash after these joins names, and divides nothing."""


def slips(
    node: ast.expr, parent: ast.AST | None, source: bytes, begin: int, starts: Sequence[int]
) -> Iterator[Slip]:
    """Walk what could go wrong with an expression that begins at a byte of a file."""

    def until(part: ast.expr) -> int:
        assert part.end_lineno is not None
        assert part.end_col_offset is not None
        return starts[part.end_lineno - 1] + part.end_col_offset - begin

    def since(part: ast.expr) -> int:
        return starts[part.lineno - 1] + part.col_offset - begin

    def between(left: ast.expr, right: ast.expr, old: str, new: str, slip: str) -> Slip:
        at = source.index(old.encode(), begin + until(left), begin + since(right)) - begin
        return at, at + len(old), new, slip

    end = until(node)
    match node:
        case ast.Compare(ops=[op], comparators=[right]) if type(op) in COMPARED:
            if not (_is_text(node.left) or _is_text(right)):
                old, *others = COMPARED[type(op)]
                for new in others:
                    yield between(node.left, right, old, new, "comparison")
        case ast.BinOp(left=left, op=op, right=right):
            if _is_text(left) or _is_text(right) or _joins_names(node):
                return
            one, other = ast.unparse(left), ast.unparse(right)
            if type(op) in COMPUTED:
                yield between(left, right, *COMPUTED[type(op)], "arithmetic")
                yield 0, end, f"({one})", "term or factor dropped"
            if isinstance(op, ast.Sub | ast.Div | ast.MatMult) and one != other:
                sign = {ast.Sub: "-", ast.Div: "/", ast.MatMult: "@"}[type(op)]
                yield 0, end, f"({other}) {sign} ({one})", "operands swapped"
        case ast.UnaryOp(op=ast.USub()) if is_axis(parent):
            yield 0, end, "0", "axis"
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            yield 0, end, f"({ast.unparse(operand)})", "sign"
        case ast.UnaryOp(op=ast.Not() | ast.Invert(), operand=operand):
            yield 0, end, f"({ast.unparse(operand)})", "negation dropped"
        case ast.BoolOp(op=op, values=[left, right, *_]):
            old, new = ("and", "or") if isinstance(op, ast.And) else ("or", "and")
            yield between(left, right, old, new, "and, or")
        case ast.Constant(value=value) if type(value) in (int, float):
            if is_axis(parent):
                yield 0, end, "1" if value == 0 else "0", "axis"
            else:
                yield from _other_numbers(value, end, signed=isinstance(parent, ast.UnaryOp))
        case ast.Attribute(value=value, attr="T"):
            yield 0, end, ast.unparse(value), "transposition dropped"
        case ast.Call(func=function, args=args):
            name = function.attr if isinstance(function, ast.Attribute) else ast.unparse(function)
            if name in SWAPPED and len(args) >= 2:
                first, second = args[-2:]
                text = f"{ast.unparse(second)}, {ast.unparse(first)}"
                yield since(first), until(second), text, "arguments swapped"
            if name in EXCHANGED:
                at = until(function)
                yield at - len(name), at, EXCHANGED[name], "function"
            if name in DROPPED and args:
                yield 0, end, f"({ast.unparse(args[0])})", "function dropped"
            if name in TURNED and isinstance(function, ast.Attribute) and not args:
                yield 0, end, f"({ast.unparse(function.value)})", "inverse dropped"


def _other_numbers(value: float, end: int, *, signed: bool) -> Iterator[Slip]:
    if isinstance(value, int):
        yield 0, end, str(value + 1), "number"
        if value > 0:
            yield 0, end, str(value - 1), "number"
        return
    if value == 0.0:
        yield 0, end, "1.0", "number"
        return
    yield 0, end, repr(value * 1.01), ONE_PERCENT
    yield 0, end, repr(value * 2.0), "number"
    if not signed:
        yield 0, end, f"(-{value!r})", "sign"


def is_axis(parent: ast.AST | None) -> bool:
    """Tell whether what stands below is the number of an axis."""
    return isinstance(parent, ast.keyword) and parent.arg == "axis"


def _is_text(node: ast.expr) -> bool:
    if isinstance(node, ast.BinOp):
        return _is_text(node.left) or _is_text(node.right)
    return isinstance(node, ast.JoinedStr) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str | bytes | None)
    )


def _joins_names(node: ast.BinOp) -> bool:
    return isinstance(node.op, ast.Div) and ast.unparse(node.left).lower().endswith(PLACES)
