"""Folder for roverlink's cache files in the user's home. The files make later runs faster, and may be deleted."""

from __future__ import annotations

import os
from pathlib import Path


def cache_folder() -> Path:
    """Return the folder for roverlink's caches: ``$XDG_CACHE_HOME/roverlink``, or else ``~/.cache/roverlink``."""
    # XDG Base Directory specification: "All paths set in these environment variables must be absolute. If an
    # implementation encounters a relative path ... it should consider the path invalid and ignore it."
    given = Path(os.environ.get("XDG_CACHE_HOME", ""))
    return (given if given.is_absolute() else Path(os.path.expanduser("~"), ".cache")) / "roverlink"
