"""Reference of the classes that targets and templates see, read from the sources of the IR."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator
from types import ModuleType

from roverlink.generator.ir import interfaces, model

_HEAD = """\
# Classes for templates and targets

A template or a target gets a `Bridge`. The bridge consists of frozen dataclasses. Lists are tuples in a fixed order, so
the same table gives the same bytes. [Generated code](../targets.md#templates-of-your-own) explains how to use them.
"""


def page() -> str:
    """Return the page with every class of the IR, the bridge first."""
    classes = [node for module in (model, interfaces) for node in _classes(module)]
    classes.sort(key=lambda node: node.name != "Bridge")
    return "\n".join([_HEAD, *(line for node in classes for line in _section(node))])


def _classes(module: ModuleType) -> Iterator[ast.ClassDef]:
    tree = ast.parse(inspect.getsource(module))
    yield from (node for node in tree.body if isinstance(node, ast.ClassDef))


def _section(node: ast.ClassDef) -> Iterator[str]:
    yield from (f"## {node.name}", "", ast.get_docstring(node) or "", "")
    rows = list(_rows(node))
    if rows:
        yield from ("| name | type | meaning |", "|---|---|---|", *rows, "")


def _rows(node: ast.ClassDef) -> Iterator[str]:
    """Return a row for each attribute, with the text that follows it, and for each public method."""
    for index, part in enumerate(node.body):
        if isinstance(part, ast.AnnAssign):
            yield _row(ast.unparse(part.target), ast.unparse(part.annotation), _text_after(node.body, index))
        elif isinstance(part, ast.Assign):
            yield _row(ast.unparse(part.targets[0]), "", _text_after(node.body, index))
        elif isinstance(part, ast.FunctionDef) and not part.name.startswith("_") and part.returns:
            called = "" if any(ast.unparse(one) == "property" for one in part.decorator_list) else "()"
            yield _row(f"{part.name}{called}", ast.unparse(part.returns), ast.get_docstring(part) or "")


def _text_after(body: list[ast.stmt], index: int) -> str:
    following = body[index + 1 : index + 2]
    if following and isinstance(following[0], ast.Expr) and isinstance(following[0].value, ast.Constant):
        return str(following[0].value.value)
    return ""


def _row(name: str, type: str, meaning: str) -> str:
    shown_type = f"`{type}`".replace("|", "\\|") if type else ""
    return f"| `{name}` | {shown_type} | {' '.join(meaning.split())} |"
