"""Rules, and the diagnostics that they raise. A diagnostic is a fault with its place and a suggested repair."""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from types import ModuleType
from typing import ClassVar

from roverlink.generator.git import Commit, shortened
from roverlink.generator.source_files import visible

_WIDEST = 72  # columns of the text about a use, where nothing else limits it
_LONGEST_AUTHOR = 20  # characters of an author's name, so that the subject has room beside it


class Severity(str, Enum):
    """Severity of a diagnostic. It decides if files are written, and the exit code."""

    FATAL = "fatal"
    """An input cannot be read, or an output cannot be written; the exit code is 2."""
    ERROR = "error"
    """The input is wrong; nothing is written, and the exit code is 1."""
    WARNING = "warning"
    """The input is questionable; the run goes on, but `lint` exits with 1."""
    HINT = "hint"
    """The input is right, but could be better; the exit code stays the same."""

    @property
    def rank(self) -> int:
        """The severity as a number: 0 for the most severe."""
        return list(Severity).index(self)


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A place in a file.

    Line and column count from 1. A line of 0 stands for the whole file. As text, unprintable characters of the file's
    name are escaped.
    """

    file: str
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        return ":".join([self.name, *(str(part) for part in (self.line, self.column) if part)])

    @property
    def name(self) -> str:
        """The file's name for people: unprintable characters are escaped."""
        return visible(self.file).replace("\n", "\\n")


def shown(folder: str, path: str) -> str:
    """Join a folder and a path to the file name that diagnostics show.

    The folder ``proto`` and the path ``imu.proto`` give ``proto/imu.proto``; the folder ``.`` gives ``imu.proto``. The
    folder may also be a git ref with a colon: ``main:`` gives ``main:imu.proto``.
    """
    if folder in ("", "."):
        return path
    return f"{folder}{path}" if folder.endswith(":") else f"{folder}/{path}"


class Rule:
    """A kind of diagnostic, with an id such as ``ENV101``. Each rule is a subclass; its docstring is its documentation.

    The id of a removed rule is never given to a new rule. The class's name also is the rule's name: ``NameTaken`` is
    ``name-taken``.

    The first line of the documentation says what the rule finds. The next lines say why that is a fault. The sections
    ``Bad::`` and ``Good::`` follow, each with one example. An example is a part of a project: rows or sections of
    mapping.yaml, or a .proto file. A comment that consists of a path starts another file. If files cannot show the
    fault, the example is the output of a command.
    """

    id: ClassVar[str]
    name: ClassVar[str]
    severity: ClassVar[Severity]
    documentation: ClassVar[str]
    explanation: ClassVar[str]
    """The documentation for people, without the markup of reStructuredText."""
    summary: ClassVar[str]
    """The first line of the documentation."""

    def __init_subclass__(cls, id: str, severity: Severity = Severity.ERROR) -> None:
        cls.id, cls.severity, cls.documentation = id, severity, inspect.getdoc(cls) or ""
        cls.name = re.sub(r"(?<=.)([A-Z]|\d+)", r"-\1", cls.__name__).lower()
        cls.explanation = re.sub(r"^(Bad|Good)::$", r"\1:", cls.documentation.strip(), flags=re.MULTILINE)
        cls.summary = cls.documentation.partition("\n")[0]

    @classmethod
    def at(
        cls,
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
        """Return a diagnostic of this rule at a place.

        ``also`` lists related places, each with a text. ``type`` is the full name of the message or enum concerned.
        ``number`` is the number of the field or enum value, or of the payload in the envelope. ``uses`` are the
        meanings that the number had in history. ``rests_on`` are places that the diagnostic assumes to be right: if one
        of them has an error itself, the diagnostic is dropped (see `independent`). Unprintable characters of the texts,
        which may quote a stranger's file, are escaped.
        """
        rests = tuple(rests_on)
        related = tuple((place, visible(text)) for place, text in also)
        message, help = visible(message), visible(help)
        return Diagnostic(cls, span, message, help, related, type, number, cls.severity, tuple(uses), rests)


def rules_in(module: ModuleType) -> dict[str, type[Rule]]:
    """Return the rules that a module declares, by their ids."""
    classes = [item for item in vars(module).values() if isinstance(item, type) and item.__module__ == module.__name__]
    return {rule.id: rule for rule in classes if issubclass(rule, Rule) and rule is not Rule}


@dataclass(frozen=True, slots=True)
class Use:
    """One meaning that a field number or enum number had in git's history: the field or enum value that had it.

    If a message kept its name and got other fields, this is the field of that type with one content of the message.
    """

    type: str
    """Type of the field, such as ``float`` or the full name of a message; empty for an enum value."""
    name: str
    """Name of the field or enum value."""
    came: Commit
    """The first commit with this meaning."""
    went: Commit | None
    """The last commit that removed this meaning; None if a branch still has it."""
    declaration: tuple[str, ...]
    """The lines of the declaration in a .proto file, such as ``("Gps gps = 2;",)``.

    For the content of a message, these are the fields that differ from the other content. A line is empty if only the
    other content has a field with this number.
    """
    place: Span
    """The place of the declaration at the commit ``came``. Today the file may have another content, or not exist."""
    today: str = ""
    """Place where the meaning exists today, such as ``on the branch main``; empty if it exists nowhere."""
    doubt: str = ""
    """Why it is not certain that the number had this meaning; empty if it is certain."""

    def text(self, file: str, widest: int = _WIDEST) -> list[str]:
        """Return lines for people: the declaration, its place, and the commits that added and removed it.

        ``file`` is the name of the file to show. Lines with the subject of a commit are cut to ``widest`` characters,
        or fewer if that is more than anybody wants to read.
        """
        widest = min(widest, _WIDEST)
        lines = [str(Span(file, self.place.line))]
        if self.came.id or not self.today:
            lines += _event("since", self.came, widest)
        if self.went:
            lines += _event("until", self.went, widest)
        elif self.today:
            lines.append(f"now {self.today}")
        if self.doubt:
            lines.append(f"in doubt: {self.doubt}")
        return [*map(visible, self.declaration), *(f"  {line}" for line in lines)]


def _event(word: str, commit: Commit, widest: int) -> list[str]:
    if not commit.id:
        return [f"{word} {commit.subject}"]
    about = f"{shortened(commit.author, _LONGEST_AUTHOR)}: {commit.subject}"
    return [f"{word} {commit.id[:10]} {commit.date}", f"  {shortened(about, widest - 4)}"]


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A fault at a place in a file, with the rule that found it."""

    rule: type[Rule]
    span: Span
    message: str
    help: str = ""
    also: tuple[tuple[Span, str], ...] = ()
    type: str = ""
    """Full name of the message or enum that the diagnostic is about; empty if it is about none."""
    number: int | None = None
    """Number of the field, enum value or payload that the diagnostic is about; None if it is about none."""
    severity: Severity = Severity.ERROR
    """Severity of this diagnostic: the rule's severity, or a lower one that the table sets."""
    uses: tuple[Use, ...] = ()
    """Meanings that the number had in history, the earliest first. Only rules about history set this."""
    rests_on: tuple[Span, ...] = ()
    """Places that the diagnostic assumes to be right. If one of them has an error, the diagnostic is dropped."""
    known: bool = False
    """True if the baseline has the fault already, or if the user has accepted it. It is then a hint."""

    def as_known(self) -> Diagnostic:
        """Return the diagnostic as a hint about a fault that the baseline has already, or that the user accepted."""
        return dataclasses.replace(self, severity=Severity.HINT, known=True)

    def render(self) -> str:
        """Return the diagnostic as text, in several lines: place, severity and message, related places, help."""
        lines = [f"{self.span}: {self.severity.value}[{self.rule.id}] {self.message}"]
        lines += [f"  {line}" for use in self.uses for line in use.text(use.place.file) if line]
        lines += [f"  {span}: {text}" for span, text in self.also]
        if self.help:
            lines.append(f"  help: {self.help}")
        return "\n".join(lines)


class DiagnosticsError(Exception):
    """Raised when the generator cannot continue; ``findings`` contains the diagnostics that say why.

    ``texts`` maps the name of a file to its text, for a file whose text differs from the disk or is not on disk. The
    command line quotes the source lines of the diagnostics from it.
    """

    def __init__(self, findings: Iterable[Diagnostic], texts: Mapping[str, str] | None = None) -> None:
        self.findings = tuple(in_order(findings))
        self.texts = texts or {}
        super().__init__("\n".join(finding.render() for finding in self.findings))


def independent(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Return the diagnostics without those that only follow from an error at another place (`Diagnostic.rests_on`).

    A diagnostic is dropped if one of its `rests_on` places has an error. Errors that have `rests_on` places themselves
    do not count for this, so two diagnostics never drop each other.
    """
    findings = list(findings)
    # A mistake at one place often makes another place look wrong. Only the first is worth the user's time: with it, the
    # others go away, or show what they really are.
    wrong = {
        finding.span for finding in findings if finding.severity.rank <= Severity.ERROR.rank and not finding.rests_on
    }
    return [finding for finding in findings if wrong.isdisjoint(finding.rests_on)]


def in_order(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Sort diagnostics by place, then by rule id. Drops duplicates, and diagnostics that only follow from others."""
    return sorted(set(independent(findings)), key=lambda finding: (finding.span, finding.rule.id, finding.message))


def has_errors(findings: Iterable[Diagnostic]) -> bool:
    """Return True if the severity of at least one diagnostic is error or fatal."""
    return any(finding.severity.rank <= Severity.ERROR.rank for finding in findings)
