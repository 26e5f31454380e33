"""Findings of a check with all that the output formats need to show them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from roverlink.diagnostic_text import Sources
from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.numerals import counted

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
    extent: str = ""
    """Text for people about what the command has looked at; empty if it always looks at everything."""
    with_known: bool = False
    """True if formats for people show also the findings that are known (`Diagnostic.known`)."""

    @property
    def shown(self) -> list[Diagnostic]:
        """The findings that formats for people show."""
        return [finding for finding in self.findings if self.with_known or not finding.known]

    @property
    def left_out(self) -> str:
        """One line about the known findings that are not shown; empty if there are none."""
        count = len(self.findings) - len(self.shown)
        return (
            f"{counted(count, 'known problem')} not shown; --all shows {'it' if count == 1 else 'them'}"
            if count
            else ""
        )
