"""Import of the code that ``roverlink generate`` wrote for a project, and comparison with its sources."""

from __future__ import annotations

from pathlib import Path

import yaml

from roverlink.console import TABLE
from roverlink.generator import source_files
from roverlink.generator.content_digest import proto_digest, table_digest, text_at
from roverlink.runtime import Registry, load_registry
from roverlink.runtime.core.mirror import end_named, mirrored

_DEEPEST = 5
"""Most parts of an import name that are looked for."""


def load_project(folder: Path, end: str = "") -> Registry:
    """Import the generated code of the project in ``folder``, and return its registry: the list of all handlers.

    The import name of the generated code is the table's ``python.package``, or ``generated`` if there is no readable
    table. ``end`` is a peer or board if the registry is for its end of the link, and not for the rover's. Raises
    `RegistryError` in the same cases as `load_registry`, and `SetupError` if the table has no such end.
    """
    registry = _load(folder)
    if not end:
        return registry
    from roverlink.runtime.ros_arguments.parameters import LISTEN_PORT  # here: few commands need the parameters

    return mirrored(registry, end_named(registry, end), int(LISTEN_PORT))


def _load(folder: Path) -> Registry:
    package = text_at(folder / TABLE, "python", "package") or _package_in(folder)
    return load_registry(folder, package) if package else load_registry(folder)


def _package_in(folder: Path) -> str:
    """Return the import name of the generated code in a folder without a table, as a ROS 2 package installs it.

    Empty if there is none, or a table.
    """
    if (folder / TABLE).exists():
        return ""
    found = (path for depth in range(1, _DEEPEST + 1) for path in folder.glob("*/" * depth + "registry.py"))
    return next((".".join(path.relative_to(folder).parts[:-1]) for path in found), "")


def changed_sources(folder: Path, registry: Registry) -> list[str]:
    """Return the table and the .proto files that have changed since the last `roverlink generate`.

    They are named by their paths in the project. A file that is not in the project is not compared: a rover may carry
    the generated code alone.
    """
    return [name for name, digest in registry.sources.items() if _digest_now(folder / name) not in (None, digest)]


def _digest_now(path: Path) -> str | None:
    """Return the digest of a file, or an empty text if it cannot be read; None if there is none."""
    path = path.resolve()
    try:
        text = source_files.read(path.parent, path.name).decode("utf-8", "replace")
        return (proto_digest if path.suffix == ".proto" else table_digest)(text)
    except FileNotFoundError:
        return None
    except (OSError, yaml.YAMLError, RecursionError):
        return ""
