"""Parts of a reference page about Python classes, read from the sources: definitions, attributes and texts."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Iterator
from types import FunctionType

Function = ast.FunctionDef | ast.AsyncFunctionDef
_PROPERTIES = {"property", "cached_property"}


def class_definition(cls: type) -> ast.ClassDef:
    """Return the syntax tree of a class."""
    return next(node for node in _statements(cls) if isinstance(node, ast.ClassDef))


def function_definition(function: FunctionType) -> Function:
    """Return the syntax tree of a function."""
    return next(node for node in _statements(function) if isinstance(node, Function))


def attribute_rows(node: ast.ClassDef) -> Iterator[str]:
    """Return a row of a table for each public attribute, with the text that follows it, and for each property."""
    for index, part in enumerate(node.body):
        if isinstance(part, ast.AnnAssign) and not ast.unparse(part.target).startswith("_"):
            yield row(ast.unparse(part.target), ast.unparse(part.annotation), _text_after(node.body, index))
        elif isinstance(part, ast.Assign) and not ast.unparse(part.targets[0]).startswith("_"):
            yield row(ast.unparse(part.targets[0]), "", _text_after(node.body, index))
        elif isinstance(part, ast.FunctionDef) and part.returns and _PROPERTIES & _decorators(part):
            yield row(part.name, ast.unparse(part.returns), ast.get_docstring(part) or "")


def public_methods(node: ast.ClassDef) -> Iterator[Function]:
    """Return the methods whose name has no leading underscore; of an overloaded one, only the implementation."""
    methods = (part for part in node.body if isinstance(part, Function) and not part.name.startswith("_"))
    yield from (method for method in methods if not {"overload", *_PROPERTIES} & _decorators(method))


def row(name: str, type: str, meaning: str) -> str:
    """Return a row of a table with the columns name, type and meaning."""
    shown_type = f"`{type}`".replace("|", "\\|") if type else ""
    return f"| `{name}` | {shown_type} | {' '.join(meaning.split())} |"


def table(rows: list[str]) -> list[str]:
    """Return the lines of a table with the columns name, type and meaning; none without rows."""
    return ["| name | type | meaning |", "|---|---|---|", *rows, ""] if rows else []


def _statements(described: type | FunctionType) -> list[ast.stmt]:
    return ast.parse(textwrap.dedent(inspect.getsource(described))).body


def _decorators(method: Function) -> set[str]:
    return {ast.unparse(decorator) for decorator in method.decorator_list}


def _text_after(body: list[ast.stmt], index: int) -> str:
    following = body[index + 1 : index + 2]
    if following and isinstance(following[0], ast.Expr) and isinstance(following[0].value, ast.Constant):
        return str(following[0].value.value)
    return ""
