"""Loading of a project's generated code."""

from __future__ import annotations

from pathlib import Path

from roverlink.console import TABLE
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError
from roverlink.generator.table import reader
from roverlink.runtime import Registry, load_registry


def load_project(folder: Path) -> Registry:
    """Load the registry of a project.

    The import name is the table's ``python.package``; it is ``generated`` if there is no readable table. Raises
    `RegistryError` as `load_registry` does.
    """
    ignored: list[Diagnostic] = []  # only `generate` and `lint` show them
    try:
        return load_registry(folder, reader.read(folder / TABLE, ignored).python.package)
    except DiagnosticsError:
        return load_registry(folder)
