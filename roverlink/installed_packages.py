"""Look-ups in the metadata of installed Python packages: versions, entry points, and what to install.

This is a module of its own because importlib.metadata is slow to import and few commands need it.
"""

from __future__ import annotations

import importlib.metadata
import json
import re
from collections.abc import Collection, Iterable
from pathlib import Path

_PACKAGES = {
    **{name: name for name in ("argcomplete", "black", "jinja2", "mcap", "pyarrow", "rich", "rosbags")},
    "can": "python-can",
    "foxglove": "foxglove-sdk",
    "google": "protobuf",
    "grpc_tools": "grpcio-tools",
    "isotp": "can-isotp",
    "yaml": "pyyaml",
    "lz4": "mcap",
    "prometheus_client": "prometheus-client",
    "serial": "pyserial",
    "zstandard": "mcap",
}
"""Packages that roverlink imports, by the first part of a module's name."""
EXTRAS = {
    "mcap": "record",
    "foxglove-sdk": "foxglove",
    "prometheus-client": "metrics",
    "pyarrow": "parquet",
    "rosbags": "standard",
    "nanopb": "nanopb",
    "pyserial": "serial",
    "python-can": "can",
}
"""Extras of roverlink's package, by the package that each one installs."""


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


def cure(error: ImportError) -> str | None:
    """Return what is missing and what the user can do about it; None if roverlink needs no package with this module."""
    first, *others = (error.name or "").split(".")
    if first == "roverlink" and others and (link := Path(__file__).with_name(others[0])).is_file():
        return (
            f"{link} should be a symbolic link and is a file, because git has cloned without symbolic links; run "
            "`git config core.symlinks true` and `git checkout .` in the clone, or install the wheel"
        )
    if first not in _PACKAGES:
        return None
    package, missing = _PACKAGES[first], f"the Python module {first} cannot be imported ({error})"
    if package in EXTRAS:
        return f"{missing}; {with_extras([EXTRAS[package]])}"
    wanted = re.compile(rf"{package}(?![\w-])[^;]*", re.IGNORECASE)
    try:
        needed = importlib.metadata.requires("roverlink") or []
    except importlib.metadata.PackageNotFoundError:  # running from the source files
        needed = []
    requirement = next((match[0].strip() for match in map(wanted.match, needed) if match), package)
    return f"{missing}; install its package with `pip install '{requirement}'`"


def with_extras(extras: Iterable[str]) -> str:
    """Return the advice to install some extras of roverlink's package, as docs/install.md explains them."""
    names = ",".join(extras)
    return (
        f"install roverlink with {names!r}: `pip install 'SOURCE[{names}]'`, where SOURCE is the wheel or the checkout "
        "of roverlink"
    )
