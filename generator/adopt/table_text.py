"""Conversion of a draft to the text of mapping.yaml; the reasons in the draft become comments."""

from __future__ import annotations

from roverlink.generator.adopt.draft import Draft
from roverlink.generator.emit.render import render
from roverlink.generator.source_files import visible
from roverlink.generator.table.edit import quoted, scalar

_WIDTH = 110


def text_of(draft: Draft) -> str:
    """Return the text of mapping.yaml for a draft."""
    spelling = {"scalar": scalar, "quoted": quoted, "commented": _commented, "visible": visible}
    return render("project/drafted_mapping.yaml.j2", draft=draft, **spelling)


def _commented(line: str, comment: str) -> str:
    """Return a line with a comment: behind the line, or above it if both together are too long."""
    if not comment:
        return line
    comment = " ".join(visible(comment).split())
    if len(line) + len(comment) < _WIDTH:
        return f"{line}  # {comment}"
    margin = " " * (len(line) - len(line.lstrip()))
    return f"{margin}# {comment}\n{line}"
