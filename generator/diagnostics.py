"""Rules, and the diagnostics that they raise: a fault, its place and the suggested repair."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from roverlink.generator.git import Commit


class Severity(str, Enum):
    """The effect of a diagnostic on a run."""

    FATAL = "fatal"
    """An input cannot be read, or an output cannot be written; the exit code is 2."""
    ERROR = "error"
    """The input is wrong; nothing is written, and the exit code is 1."""
    WARNING = "warning"
    """The input is questionable; the run goes on, but `lint` exits with 1."""
    HINT = "hint"
    """A remark that is not a fault; the exit code stays the same."""

    @property
    def rank(self) -> int:
        """The severity as a number: 0 for the most severe."""
        return list(Severity).index(self)


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A place in a file.

    Line and column count from 1. A line of 0 stands for the whole file.
    """

    file: str
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        return ":".join([self.file, *(str(part) for part in (self.line, self.column) if part)])


def shown(folder: str, path: str) -> str:
    """Join a folder and a path for display: ``proto/imu.proto``, or ``main:imu.proto`` for a git ref."""
    return f"{folder}{path}" if not folder or folder.endswith(":") else f"{folder}/{path}"


@dataclass(frozen=True, slots=True)
class Rule:
    """A kind of diagnostic.

    An id is never given to another rule, even after its own rule is gone.

    The first line of the documentation says what the rule finds. Then it says why that is a fault. It ends with the
    sections ``Bad::`` and ``Good::``, each with one example. An example is a part of a project: rows or sections of
    mapping.yaml, or a .proto file. A comment with a path starts another file. If files cannot show the fault, the
    example is a terminal's text.
    """

    id: str
    name: str
    documentation: str
    severity: Severity = Severity.ERROR

    @property
    def summary(self) -> str:
        """The first line of the documentation."""
        return self.documentation.strip().splitlines()[0]

    def at(
        self,
        span: Span,
        message: str,
        help: str = "",
        also: Sequence[tuple[Span, str]] = (),
        *,
        type: str = "",
        number: int | None = None,
        uses: Sequence[Use] = (),
        rests_on: Sequence[Span] = (),
    ) -> Diagnostic:
        """Return a diagnostic of this kind.

        ``also`` lists related places, each with a text. ``type`` is the full name of the message or enum concerned.
        ``number`` is the number of the field or enum value, or of the payload in the envelope. ``uses`` are the
        meanings that the number had in history. ``rests_on`` are places that the diagnostic assumes to be right: it is
        dropped if one of them has an error of its own (see `independent`).
        """
        rests = tuple(rests_on)
        return Diagnostic(self, span, message, help, tuple(also), type, number, self.severity, tuple(uses), rests)


@dataclass(frozen=True, slots=True)
class Use:
    """One meaning that a number had in the history of the repository."""

    type: str
    name: str
    came: Commit
    went: Commit | None
    """The commit that removed it last; None if a branch still has it."""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A fault at a place in a file."""

    rule: Rule
    span: Span
    message: str
    help: str = ""
    also: tuple[tuple[Span, str], ...] = ()
    type: str = ""
    """Full name of the message or enum concerned; empty for none."""
    number: int | None = None
    """Number of the field or enum value concerned; None for none."""
    severity: Severity = Severity.ERROR
    """The rule's severity, unless the table lowers it."""
    uses: tuple[Use, ...] = ()
    """The usages of the number, the earliest first; only diagnostics about history have any."""
    rests_on: tuple[Span, ...] = ()
    """Places that the diagnostic assumes to be right."""

    def render(self) -> str:
        """Return the diagnostic as text: place, message, related places, help."""
        lines = [f"{self.span}: {self.severity.value}[{self.rule.id}] {self.message}"]
        lines += [f"  {span}: {text}" for span, text in self.also]
        if self.help:
            lines.append(f"  help: {self.help}")
        return "\n".join(lines)


class DiagnosticsError(Exception):
    """Raised when a phase cannot go on; the diagnostics say why.

    ``texts`` holds the text of each file that the diagnostics name and that is not on disk in this state.
    """

    def __init__(self, findings: Iterable[Diagnostic], texts: Mapping[str, str] | None = None) -> None:
        self.findings = tuple(in_order(findings))
        self.texts = texts or {}
        super().__init__("\n".join(finding.render() for finding in self.findings))


def independent(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Drop every diagnostic that only follows from an error at another place.

    An error that itself rests on other places drops nothing, so two diagnostics never drop each other.
    """
    findings = list(findings)
    wrong = {one.span for one in findings if one.severity.rank <= Severity.ERROR.rank and not one.rests_on}
    return [one for one in findings if wrong.isdisjoint(one.rests_on)]


def in_order(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Sort diagnostics by place, then id. Drops duplicates, and those that only follow from others."""
    return sorted(set(independent(findings)), key=lambda finding: (finding.span, finding.rule.id, finding.message))


def has_errors(findings: Iterable[Diagnostic]) -> bool:
    """Return True if any diagnostic is an error or fatal."""
    return any(finding.severity.rank <= Severity.ERROR.rank for finding in findings)


def nearest(word: str, known: Iterable[str], otherwise: str = "") -> str:
    """Return ``did you mean ...?`` with the most similar known word, or ``otherwise`` if no word is similar."""
    found = difflib.get_close_matches(word, list(known), 1, 0.6)
    return f"did you mean {found[0]!r}?" if found else otherwise
