"""Places as whoever reads a report finds them."""

from __future__ import annotations

import dataclasses
import os

from generator.diagnostics import Span
from generator.lint_engine import Linted


def from_here(span: Span, linted: Linted) -> Span:
    """A place in a file of the linted folder, named from the current folder; any other place as it is."""
    path = linted.folder / span.file
    return dataclasses.replace(span, file=os.path.relpath(path)) if path.exists() else span


def told(span: Span, what: str, linted: Linted) -> str:
    """What another place has to do with a finding, and the commit that its line came with, where that is known."""
    commit = linted.commit_of(span)
    return f"{what} ({commit})" if commit else what
