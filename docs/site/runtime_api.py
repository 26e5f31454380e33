"""Reference of the public modules of the runtime, read from their docstrings and signatures: a page for each module."""

from __future__ import annotations

import ast
import copy
import inspect
import re
from collections.abc import Iterator
from types import ModuleType

import black
from class_sections import Function, attributes, class_definition, function_definition, public_methods, table

from roverlink import runtime
from roverlink.runtime import client

MODULES = {"reference/runtime.md": runtime, "reference/client.md": client}
_BEFORE_LIST = re.compile(r"^(?!- |  ).+\n(?=- )", re.MULTILINE)
_MODE = black.Mode(line_length=90, is_pyi=True)


def pages() -> dict[str, str]:
    """Return the page of each module, by path."""
    return {path: "\n".join(_page(module)) for path, module in MODULES.items()}


def _page(module: ModuleType) -> Iterator[str]:
    yield from (f"# {module.__name__}", "", inspect.getdoc(module) or "", "")
    for name in module.__all__:
        exported = getattr(module, name)
        yield from (f"## {name}", "")
        if inspect.isclass(exported):
            yield from _class(exported, module)
        elif inspect.isfunction(exported):
            yield from _function(function_definition(exported))
        else:
            yield from (f"`{name} = {exported!r}`", "")


def _class(cls: type, module: ModuleType) -> Iterator[str]:
    """Return the lines about a class. What it inherits from classes that the module does not export is its own."""
    node = class_definition(cls)
    bases = [base.__name__ for base in cls.__bases__ if base.__name__ in module.__all__]
    if bases:
        yield from (f"Base class: {', '.join(f'[`{base}`](#{base.lower()})' for base in bases)}", "")
    yield from (_text(node), "")
    constructor = next((part for part in node.body if isinstance(part, Function) and part.name == "__init__"), None)
    if constructor:
        yield from _code(constructor)
    inherited = [
        class_definition(base)
        for base in cls.__mro__[1:]
        if base.__module__.startswith("roverlink.") and base.__name__ not in module.__all__
    ]
    yield from table(found for part in (node, *inherited) for found in attributes(part))
    for method in (method for part in (node, *inherited) for method in public_methods(part)):
        yield from (f"### {cls.__name__}.{method.name} {{: #{cls.__name__.lower()}-{method.name} }}", "")
        yield from _function(method)


def _function(node: Function) -> Iterator[str]:
    yield from _code(node)
    yield from (_text(node), "")


def _text(node: ast.ClassDef | Function) -> str:
    """Return a docstring as Markdown, in which a list needs an empty line before it."""
    return _BEFORE_LIST.sub(r"\g<0>\n", ast.get_docstring(node) or "")


def _code(node: Function) -> Iterator[str]:
    """Return a function's signature as a block of code."""
    stub = copy.copy(node)
    stub.body = [ast.Expr(ast.Constant(...))]
    yield from ("```python", black.format_str(ast.unparse(stub), mode=_MODE).strip(), "```", "")
