"""Import of the code that ``roverlink generate`` wrote for a project."""

from __future__ import annotations

from pathlib import Path

from roverlink.console import TABLE
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError
from roverlink.generator.table import reader
from roverlink.runtime import Registry, load_registry


def load_project(folder: Path) -> Registry:
    """Import the generated code of the project in ``folder``, and return its registry: the list of all handlers.

    The import name of the generated code is the table's ``python.package``, or ``generated`` if there is no readable
    table. Raises `RegistryError` in the same cases as `load_registry`.
    """
    ignored: list[Diagnostic] = []  # only `generate` and `lint` show them
    try:
        # The user runs this project, so a link is followed to any place: `colcon build --symlink-install` makes links.
        return load_registry(folder, reader.read((folder / TABLE).resolve(), ignored).python.package)
    except DiagnosticsError:
        return load_registry(folder)
