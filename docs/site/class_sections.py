"""Parts of a reference page about Python classes, read from the sources: definitions, attributes and texts."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Iterable, Iterator
from types import FunctionType

Function = ast.FunctionDef | ast.AsyncFunctionDef
_PROPERTIES = {"property", "cached_property"}


def class_definition(cls: type) -> ast.ClassDef:
    """Return the syntax tree of a class."""
    return next(node for node in _statements(cls) if isinstance(node, ast.ClassDef))


def function_definition(function: FunctionType) -> Function:
    """Return the syntax tree of a function."""
    return next(node for node in _statements(function) if isinstance(node, Function))


def attributes(node: ast.ClassDef) -> Iterator[tuple[str, str, str]]:
    """Return name, type and text of each public attribute and property; the text follows an attribute."""
    for index, part in enumerate(node.body):
        if isinstance(part, ast.AnnAssign):
            found = (ast.unparse(part.target), ast.unparse(part.annotation), _text_after(node.body, index))
        elif isinstance(part, ast.Assign):
            found = (ast.unparse(part.targets[0]), "", _text_after(node.body, index))
        elif isinstance(part, ast.FunctionDef) and part.returns and _PROPERTIES & _decorators(part):
            found = (part.name, ast.unparse(part.returns), ast.get_docstring(part) or "")
        else:
            continue
        if not found[0].startswith("_"):
            yield found


def public_methods(node: ast.ClassDef) -> Iterator[Function]:
    """Return the methods whose name has no leading underscore; of an overloaded one, only the implementation."""
    methods = (part for part in node.body if isinstance(part, Function) and not part.name.startswith("_"))
    yield from (method for method in methods if not {"overload", *_PROPERTIES} & _decorators(method))


def table(described: Iterable[tuple[str, str, str]]) -> list[str]:
    """Return the lines of a table with the columns name, type and meaning; none if there is nothing to describe."""
    rows = [f"| `{name}` | {_type_cell(type)} | {' '.join(meaning.split())} |" for name, type, meaning in described]
    return ["| name | type | meaning |", "|---|---|---|", *rows, ""] if rows else []


def _type_cell(type: str) -> str:
    return f"`{type}`".replace("|", "\\|") if type else ""


def _statements(described: type | FunctionType) -> list[ast.stmt]:
    return ast.parse(textwrap.dedent(inspect.getsource(described))).body


def _decorators(method: Function) -> set[str]:
    return {ast.unparse(decorator) for decorator in method.decorator_list}


def _text_after(body: list[ast.stmt], index: int) -> str:
    following = body[index + 1 : index + 2]
    if following and isinstance(following[0], ast.Expr) and isinstance(following[0].value, ast.Constant):
        return str(following[0].value.value)
    return ""
