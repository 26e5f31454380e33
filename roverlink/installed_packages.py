"""Look-up of the versions of installed packages.

This is a module of its own because importlib.metadata is slow to import and few commands need it.
"""

from __future__ import annotations

import importlib.metadata


def installed_version(package: str) -> str | None:
    """Return the version of a package; None if it is not installed."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None
