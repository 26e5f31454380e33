"""Diagnostics: what is wrong, where, and what to do about it; and the rules that raise them."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from roverlink.generator.git import Commit


class Severity(str, Enum):
    """The effect of a diagnostic on a run."""

    FATAL = "fatal"
    """Something could not be looked at, or not be written; the exit code is 2."""
    ERROR = "error"
    """Nothing is written; the exit code is 1."""
    WARNING = "warning"
    """It is shown, and the run goes on; `lint` exits with 1 all the same."""
    HINT = "hint"
    """It is shown, and is no fault."""

    @property
    def rank(self) -> int:
        """How grave it is: 0 for the gravest."""
        return list(Severity).index(self)


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A place in a file; line and column count from 1, and 0 stands for the file as a whole."""

    file: str
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        return ":".join([self.file, *(str(part) for part in (self.line, self.column) if part)])


def shown(folder: str, path: str) -> str:
    """Name a file as diagnostics do: below its folder, in a commit (``main:``), or by its path alone."""
    return f"{folder}{path}" if not folder or folder.endswith(":") else f"{folder}/{path}"


@dataclass(frozen=True, slots=True)
class Rule:
    """A kind of diagnostic. Its id is never given to another kind, even after the rule is gone.

    The documentation says in its first line what the rule finds, then why that hurts, and ends with a section
    ``Bad::`` and a section ``Good::`` that hold an example each. An example is a part of a project: rows, or whole
    sections, of mapping.yaml, or of a .proto file; a comment with a path starts a further file. Where a project alone
    does not show the rule, the example is what a terminal shows.
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
        """A diagnostic of this kind.

        ``also`` are other places that belong to it; ``type`` is the full name of the message or enum that it is
        about, ``number`` that of the field, of the enum value, or of the payload in the envelope; ``uses`` is what
        the number stood for in history. ``rests_on`` are places that it takes for granted: where one of them is
        wrong by itself, the diagnostic only follows from that and is dropped (see `independent`).
        """
        rests = tuple(rests_on)
        return Diagnostic(self, span, message, help, tuple(also), type, number, self.severity, tuple(uses), rests)


@dataclass(frozen=True, slots=True)
class Use:
    """What a number stood for in some part of history."""

    type: str
    name: str
    came: Commit
    went: Commit | None
    """Where it went last; None while some branch has it."""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One fault at one place."""

    rule: Rule
    span: Span
    message: str
    help: str = ""
    also: tuple[tuple[Span, str], ...] = ()
    type: str = ""
    """Full name of the message or enum that it is about; empty for none."""
    number: int | None = None
    """Of the field or of the enum value that it is about."""
    severity: Severity = Severity.ERROR
    """The rule's, or what the table has lowered that to."""
    uses: tuple[Use, ...] = ()
    """The usages of the number, the earliest first; empty but for a diagnostic of history."""
    rests_on: tuple[Span, ...] = ()
    """Places that it takes for granted."""

    def render(self) -> str:
        """The diagnostic as text: the place, what is wrong, the other places, the cure."""
        lines = [f"{self.span}: {self.severity.value}[{self.rule.id}] {self.message}"]
        lines += [f"  {span}: {text}" for span, text in self.also]
        if self.help:
            lines.append(f"  help: {self.help}")
        return "\n".join(lines)


class DiagnosticsError(Exception):
    """A phase cannot go on: the diagnostics say why.

    ``texts`` has the text of each file that the diagnostics name and that is not on disk as it was read.
    """

    def __init__(self, findings: Iterable[Diagnostic], texts: Mapping[str, str] | None = None) -> None:
        self.findings = tuple(in_order(findings))
        self.texts = texts or {}
        super().__init__("\n".join(finding.render() for finding in self.findings))


def independent(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Drop every diagnostic that rests on a place with an error of its own.

    An error that itself rests on other places drops nothing; so two diagnostics never drop each other.
    """
    findings = list(findings)
    wrong = {one.span for one in findings if one.severity.rank <= Severity.ERROR.rank and not one.rests_on}
    return [one for one in findings if wrong.isdisjoint(one.rests_on)]


def in_order(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Sort diagnostics by place, then id; each once, and without those that only follow from others."""
    return sorted(set(independent(findings)), key=lambda finding: (finding.span, finding.rule.id, finding.message))


def has_errors(findings: Iterable[Diagnostic]) -> bool:
    """Tell whether any diagnostic is an error."""
    return any(finding.severity.rank <= Severity.ERROR.rank for finding in findings)


def nearest(word: str, known: Iterable[str], otherwise: str = "") -> str:
    """``did you mean ...?`` with the known word nearest to one that is not, or ``otherwise``."""
    found = difflib.get_close_matches(word, list(known), 1, 0.6)
    return f"did you mean {found[0]}?" if found else otherwise
