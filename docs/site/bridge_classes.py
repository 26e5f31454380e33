"""Reference of the classes that targets and templates see, read from the sources of the IR."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from types import ModuleType

from class_sections import attributes, class_definition, public_methods, table

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
    for value in vars(module).values():
        if isinstance(value, type) and value.__module__ == module.__name__:
            yield class_definition(value)


def _section(node: ast.ClassDef) -> Iterator[str]:
    yield from (f"## {node.name}", "", ast.get_docstring(node) or "", "")
    methods = [
        (f"{method.name}()", ast.unparse(method.returns), ast.get_docstring(method) or "")
        for method in public_methods(node)
        if method.returns
    ]
    yield from table([*attributes(node), *methods])
