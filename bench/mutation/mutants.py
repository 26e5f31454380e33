"""Mutants: copies of a source file with one small fault each, drawn from a seeded sample."""

import ast
import copy
import random
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

_COMPARISONS: dict[type[ast.cmpop], ast.cmpop] = {
    ast.Lt: ast.LtE(),
    ast.LtE: ast.Lt(),
    ast.Gt: ast.GtE(),
    ast.GtE: ast.Gt(),
    ast.Eq: ast.NotEq(),
    ast.NotEq: ast.Eq(),
    ast.In: ast.NotIn(),
    ast.NotIn: ast.In(),
    ast.Is: ast.IsNot(),
    ast.IsNot: ast.Is(),
}
_ARITHMETIC: dict[type[ast.operator], ast.operator] = {
    ast.Add: ast.Sub(),
    ast.Sub: ast.Add(),
    ast.Mult: ast.Div(),
    ast.Div: ast.Mult(),
    ast.FloorDiv: ast.Div(),
    ast.Mod: ast.Mult(),
    ast.BitAnd: ast.BitOr(),
    ast.BitOr: ast.BitAnd(),
    ast.LShift: ast.RShift(),
    ast.RShift: ast.LShift(),
}
KINDS = ("comparison", "arithmetic", "logic", "condition", "number", "text", "call", "result")


@dataclass(frozen=True)
class Mutant:
    """A fault: the source text at a place of a file is replaced."""

    path: str
    """File, relative to the root of the checkout."""
    line: int
    """First line of the replaced text, from 1."""
    text: str
    """This line of the original file; it finds the place again if lines above it were added."""
    kind: str
    before: str
    after: str
    in_function: bool
    """False if the line runs at import, where the coverage of single tests says nothing."""

    def is_sound(self, root: Path) -> bool:
        """True if the file is there, and with the fault is another program that Python can read."""
        if not (root / self.path).exists():
            return False
        source = (root / self.path).read_text(encoding="utf-8")
        faulty = self.apply(source)
        return faulty is not None and faulty != source and _compiles(faulty)

    def apply(self, source: str) -> str | None:
        """Return the source with the fault, or None if the place is no longer there."""
        line = self.line_in(source)
        if line is None:
            return None
        lines = source.splitlines(keepends=True)
        head, tail = "".join(lines[: line - 1]), "".join(lines[line - 1 :])
        return head + tail.replace(self.before, self.after, 1) if self.before in tail else None

    def line_in(self, source: str) -> int | None:
        """Return the number of the line that is the text, the nearest one to where it was; None if there is none."""
        found = [number for number, line in enumerate(source.splitlines(), 1) if line == self.text]
        return min(found, key=lambda number: abs(number - self.line), default=None)


def sample(root: Path, folders: Mapping[str, int], seed: int) -> list[Mutant]:
    """Draw the given number of mutants from each folder; the kinds of fault are equally frequent in it."""
    return [mutant for folder, count in folders.items() for mutant in _of_folder(root, folder, count, seed)]


def _of_folder(root: Path, folder: str, count: int, seed: int) -> list[Mutant]:
    chance = random.Random(f"{seed} {folder}")  # noqa: S311  # no secret
    by_kind: dict[str, list[Mutant]] = {kind: [] for kind in KINDS}
    for path in sorted((root / folder).rglob("*.py")):
        for mutant in _of_file(path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")):
            by_kind[mutant.kind].append(mutant)
    for mutants in by_kind.values():
        chance.shuffle(mutants)
    drawn: list[Mutant] = []
    while len(drawn) < count and any(by_kind.values()):
        for mutants in by_kind.values():
            while mutants and len(drawn) < count:
                mutant = mutants.pop()
                if mutant.is_sound(root):
                    drawn.append(mutant)
                    break
    return drawn


def _of_file(path: str, source: str) -> Iterator[Mutant]:
    lines = source.splitlines()
    for node, kind, changed, in_function in _faults(ast.parse(source)):
        if node.end_lineno != node.lineno:
            continue
        text = lines[node.lineno - 1]
        before = text.encode()[node.col_offset : node.end_col_offset].decode()
        after = ast.unparse(changed)
        after = f"({after})" if isinstance(changed, ast.expr) and kind not in ("number", "text") else after
        # The fault must be the first of its kind on the line, or its place could not be found again by its text.
        if before and text.find(before) == len(text.encode()[: node.col_offset].decode()):
            yield Mutant(path, node.lineno, text, kind, before, after, in_function)


def _compiles(source: str) -> bool:
    try:
        compile(source, "mutant", "exec")
    except SyntaxError:
        return False
    return True


def _faults(
    tree: ast.AST, in_function: bool = False
) -> Iterator[tuple[ast.expr | ast.stmt, str, ast.expr | ast.stmt, bool]]:
    """Yield each place that can be changed, with the kind of the fault and the changed node."""
    for child in _code_below(tree):
        inside = in_function or isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        if isinstance(child, ast.expr | ast.stmt):
            for kind, changed in _changes(child):
                yield child, kind, changed, in_function
        yield from _faults(child, inside)


def _code_below(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the children without docstrings, annotations, decorators and blocks for type checkers."""
    left_out: set[int] = set()
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        left_out = {id(each) for each in (node.returns, *node.decorator_list)}
    elif isinstance(node, ast.AnnAssign | ast.arg):
        left_out = {id(node.annotation)}
    elif isinstance(node, ast.JoinedStr):
        left_out = {id(each) for each in node.values if isinstance(each, ast.Constant)}
    elif isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
        return
    for child in ast.iter_child_nodes(node):
        is_docstring = isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant)
        if id(child) not in left_out and not is_docstring:
            yield child


def _changes(node: ast.expr | ast.stmt) -> Iterator[tuple[str, ast.expr | ast.stmt]]:
    """Yield each kind of fault that a node can have."""
    changed = copy.copy(node)
    match changed:
        case ast.Compare(ops=[operator]):
            changed.ops = [_COMPARISONS[type(operator)]]
            yield "comparison", changed
        case ast.BinOp(op=operation) if type(operation) in _ARITHMETIC:
            changed.op = _ARITHMETIC[type(operation)]
            yield "arithmetic", changed
        case ast.BoolOp(op=connective):
            changed.op = ast.Or() if isinstance(connective, ast.And) else ast.And()
            yield "logic", changed
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield "logic", operand
        case ast.IfExp(test=test):
            changed.test = ast.UnaryOp(ast.Not(), test)
            yield "condition", changed
        case ast.Constant(value=bool() as truth):
            yield "logic", ast.Constant(not truth)
        case ast.Constant(value=int() | float() as number):
            yield "number", ast.Constant(number + 1)
        case ast.Constant(value=str() as text) if text:
            yield "text", ast.Constant(text + "X")
        case ast.Expr(value=ast.Call()):
            yield "call", ast.Pass()
        case ast.Return(value=ast.expr() as value) if not (isinstance(value, ast.Constant) and value.value is None):
            yield "result", ast.Return(ast.Constant(None))
