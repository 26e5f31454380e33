"""Findings of a check with all that the output formats need to show them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from roverlink.diagnostic_text import Sources
from roverlink.generator.diagnostics import Diagnostic, Rule

if TYPE_CHECKING:  # slow to import: it reads a project's earlier states
    from roverlink.generator.lint.pinned_states import PinnedStates


@dataclass(frozen=True, slots=True)
class Reported:
    """Findings of one run of a command."""

    command: str
    """Command that has found them, such as ``roverlink lint``."""
    findings: Sequence[Diagnostic]
    sources: Sources
    """Access to the files that the findings name."""
    rules: Mapping[str, type[Rule]]
    """Rules that the command checks, by their ids."""
    pinned: PinnedStates | None = None
    """Compatibility of the projects that use the .proto files; None if the command does not check that."""
