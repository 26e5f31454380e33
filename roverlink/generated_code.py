"""The generated code of a project, found by what its table says."""

from __future__ import annotations

from pathlib import Path

from roverlink.console import TABLE
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError
from roverlink.generator.table import reader
from roverlink.runtime import Registry, load_registry


def load_project(folder: Path) -> Registry:
    """Load the registry of a project.

    The import name is that of the table (``python.package``); without a table that can be read, it is ``generated``.
    Raises `RegistryError` as `load_registry`.
    """
    ignored: list[Diagnostic] = []  # `generate` and `lint` show them
    try:
        return load_registry(folder, reader.read(folder / TABLE, ignored).python.package)
    except DiagnosticsError:
        return load_registry(folder)
