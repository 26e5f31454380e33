"""Loading of the generated code of a project."""

from __future__ import annotations

from pathlib import Path

from roverlink.console import TABLE
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError
from roverlink.generator.table import reader
from roverlink.runtime import Registry, load_registry


def load_project(folder: Path) -> Registry:
    """Load the registry of the project in ``folder``.

    The import name of the generated code is the table's ``python.package``, or ``generated`` if there is no readable
    table. Raises `RegistryError` in the same cases as `load_registry`.
    """
    ignored: list[Diagnostic] = []  # only `generate` and `lint` show them
    try:
        return load_registry(folder, reader.read(folder / TABLE, ignored).python.package)
    except DiagnosticsError:
        return load_registry(folder)
