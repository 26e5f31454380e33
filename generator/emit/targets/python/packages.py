"""Files ``__init__.py`` of generated packages. They import the classes from the modules of the package."""

from __future__ import annotations

from collections.abc import Mapping

from roverlink.generator import ir
from roverlink.generator.emit.render import header, render
from roverlink.generator.emit.targets.python.imports import import_lines


def package_file(bridge: ir.Bridge, package: str, docstring: str, classes: Mapping[str, str]) -> tuple[str, str]:
    """Return path and text of a package's ``__init__.py``; ``classes`` maps the names of classes to their modules."""
    own = f"{bridge.python_package}.{package}"
    text = render(
        "package.py.j2",
        header=header(bridge.table),
        docstring=docstring,
        imports=import_lines((f"{own}.{module}", name) for name, module in classes.items()),
        names=sorted(classes),
    )
    return f"generated/{package}/__init__.py", text
