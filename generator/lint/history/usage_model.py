"""What the history of a message or an enum consists of."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, IntEnum

from roverlink.generator.git import Commit
from roverlink.generator.protos.schema import Fact


class Confidence(IntEnum):
    """How far what was read is to be trusted; the higher, the less."""

    CERTAIN = 0
    """Every file that it was read from is sound."""
    LIKELY = 1
    """Some of the files had lines that cannot be read; or what a type stands for is not in the repository."""
    DOUBTFUL = 2
    """Every file that it was read from had lines that cannot be read."""


@dataclass(frozen=True, slots=True)
class Interval:
    """From where something came to where it went, in one piece of the history."""

    came: Commit
    went: tuple[Commit, ...]
    """The commits that took it away: none while it lasts, several where branches did so each for itself."""
    path: str
    """The file in which it came, below the folder that was read."""
    line: int


@dataclass(frozen=True, slots=True)
class Usage:
    """One meaning that a number had, through all of history; what was taken away and put back is the same usage."""

    number: int
    type: str
    """As written; empty for an enum value."""
    name: str
    label: str
    oneof: str
    intervals: tuple[Interval, ...]
    """The earliest first."""
    live_at: tuple[str, ...]
    """The branches, here and on remotes, that have it today."""
    went: Commit | None
    """Where it went last; None while some branch has it."""
    confidence: Confidence

    @property
    def came(self) -> Commit:
        """Where it came first."""
        return self.intervals[0].came

    @property
    def path(self) -> str:
        """The file in which it came first."""
        return self.intervals[0].path

    @property
    def line(self) -> int:
        """Where it stood there."""
        return self.intervals[0].line

    @property
    def fact(self) -> Fact:
        """What it says."""
        return Fact(self.number, self.name, self.type, self.label, self.oneof)


@dataclass(frozen=True, slots=True)
class Content:
    """The fields of a message, or the values of an enum, as a commit has them."""

    type: str
    """Full name."""
    commit: Commit
    facts: tuple[Fact, ...]
    """By number."""
    path: str
    line: int
    broken: bool
    """Whether the file has lines that cannot be read, so that there may be more."""
    enum: bool
    there: bool = True
    """Whether the commit that was asked about declares it; otherwise, this is of the nearest commit that does."""


class Kind(Enum):
    """What became of a number."""

    REUSED = "another message, with other contents"
    REPLACED = "the same message by name, whose contents were replaced"
    RETYPED = "another type, which reads the bytes otherwise"
    MEANING = "another name, which has no word of the old one"
    RENAMED = "the same thing under another name"


class Relation(Enum):
    """How two uses of a number stand to each other in the graph of commits."""

    SUCCESSION = "the later one came after the earlier one had gone, on one line of history"
    BRANCHES = "neither knew of the other's end: they were given on different branches"
    TOGETHER = "they stood in one state at once"


@dataclass(frozen=True, slots=True)
class Reuse:
    """Two uses of one number of a message or an enum."""

    owner: str
    """Full name of the message or enum."""
    number: int
    kind: Kind
    earlier: Usage
    later: Usage
    """The same one as `earlier` where the contents were replaced under the same name."""
    relation: Relation
    at_once: bool
    """Whether there was a time, by the committers' clocks, at which both were in use, be it on different branches."""
    old: Content | None
    """What the earlier type stood for when it was used last; None where it is no message or enum, or is not known."""
    new: Content | None
    """What the later type stood for when it came."""
    survivors: int
    """How many of the old fields are among the new ones."""
    confidence: Confidence

    @property
    def real(self) -> bool:
        """Whether bytes of the one are read as the other; a mere rename does no harm to them."""
        return self.kind is not Kind.RENAMED


@dataclass(frozen=True, slots=True)
class Allocation:
    """A number that a branch has given to something since it left the default branch."""

    refs: tuple[str, ...]
    """The branches; several where they agree."""
    type: str
    name: str
    came: Commit
    path: str
    line: int


@dataclass(frozen=True, slots=True)
class Collision:
    """A number that branches have given to different things, none knowing of the other."""

    number: int
    allocations: tuple[Allocation, ...]
