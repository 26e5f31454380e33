"""Look-up of the versions of installed Python packages.

This is a module of its own because importlib.metadata is slow to import and few commands need it.
"""

from __future__ import annotations

import importlib.metadata
import json
from collections.abc import Collection


def installed_version(package: str) -> str | None:
    """Return the version of a Python package, such as ``6.33.0``; None if the package is not installed."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def entry_points(group: str) -> Collection[importlib.metadata.EntryPoint]:
    """Return the entry points of a group that installed packages declare, sorted by name."""
    return sorted(importlib.metadata.entry_points(group=group), key=lambda entry: entry.name)


def git_source(package: str) -> str:
    """Return the argument of ``pip install`` for the commit of a git repository from which a package was installed.

    The text is for another computer. An example is ``git+https://example.com/rover.git@4c1f09ab27...``. It is empty if
    the package was installed from something else, such as a wheel, or from a repository on this computer, or is not
    installed. It contains no password.
    """
    try:
        # "Direct URL Data Structure" of the Python Packaging User Guide; pip leaves passwords out of the file.
        text = importlib.metadata.distribution(package).read_text("direct_url.json")
    except importlib.metadata.PackageNotFoundError:
        return ""
    source = json.loads(text or "{}")
    version = source.get("vcs_info", {})
    if version.get("vcs") != "git" or source["url"].startswith("file:"):
        return ""
    return f"git+{source['url']}@{version['commit_id']}"
