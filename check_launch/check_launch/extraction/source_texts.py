"""Texts in the sources of a package that may be names of parameters and topics, however the code uses them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from check_launch.expansion.source_trees import source_folders
from check_launch.extraction.class_facts import LARGEST_SOURCE
from roverlink import bounded_files

_NAME = r"(~?[\w./-]{2,80})"
_CPP = re.compile(rf"//[^\n]*|/\*.*?\*/|\"{_NAME}\"|\"(?:[^\"\\\n]|\\.)*\"", re.DOTALL)
_PYTHON = re.compile(
    rf"#[^\n]*|\"\"\".*?\"\"\"|'''.*?'''|\"{_NAME}\"|\"(?:[^\"\\\n]|\\.)*\"|'{_NAME}'|'(?:[^'\\\n]|\\.)*'", re.DOTALL
)
_TEXTS = {".cpp": _CPP, ".cc": _CPP, ".hpp": _CPP, ".h": _CPP, ".py": _PYTHON}
_NO_NODES = frozenset({"launch", "test", "tests"})


def texts_of_sources(folder: Path) -> Iterator[str]:
    """Yield the texts in the sources of the package in a folder, without its tests and launch files."""
    for inner, _, names in source_folders(folder):
        for path in (inner / name for name in names):
            kind = _TEXTS.get(path.suffix)
            if kind is None or set(inner.relative_to(folder).parts) & _NO_NODES or path.name.endswith("launch.py"):
                continue
            try:
                source = bounded_files.read(path, LARGEST_SOURCE).decode(errors="replace")
            except OSError:  # not readable, or too large to be source code
                continue
            yield from (match[match.lastindex] for match in kind.finditer(source) if match.lastindex)
