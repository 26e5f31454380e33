"""The model of a number's history: usages, contents and reuses."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, IntEnum

from roverlink.generator.git import Commit
from roverlink.generator.protos.schema import Fact


class Confidence(IntEnum):
    """The confidence in a fact; a higher value means less confidence."""

    CERTAIN = 0
    """All files that it was read from are complete."""
    LIKELY = 1
    """Some of the files have unreadable lines, or the field's type is not in the repository."""
    DOUBTFUL = 2
    """All of the files have unreadable lines."""


@dataclass(frozen=True, slots=True)
class Interval:
    """The time from the commit that added a fact to the commits that deleted it."""

    came: Commit
    went: tuple[Commit, ...]
    """The commits that deleted it: none if it still exists, several if branches deleted it separately."""
    path: str
    """The file in which it began, below the folder that was read."""
    line: int


@dataclass(frozen=True, slots=True)
class Usage:
    """One meaning of a number in all of history. A fact that was deleted and put back is the same usage."""

    number: int
    type: str
    """The type as written; empty for an enum value."""
    name: str
    label: str
    oneof: str
    intervals: tuple[Interval, ...]
    """The intervals, the earliest first."""
    live_at: tuple[str, ...]
    """The local and remote branches that have it today."""
    went: Commit | None
    """The commit that deleted it last; None if a branch still has it."""
    confidence: Confidence

    @property
    def came(self) -> Commit:
        """The commit that added it first."""
        return self.intervals[0].came

    @property
    def path(self) -> str:
        """The file in which it was added first."""
        return self.intervals[0].path

    @property
    def line(self) -> int:
        """Its line in that file."""
        return self.intervals[0].line

    @property
    def fact(self) -> Fact:
        """The usage as a fact."""
        return Fact(self.number, self.name, self.type, self.label, self.oneof)


@dataclass(frozen=True, slots=True)
class Content:
    """The fields of a message, or the values of an enum, at a commit."""

    type: str
    """Full name of the message or enum."""
    commit: Commit
    facts: tuple[Fact, ...]
    """The facts, sorted by number."""
    path: str
    line: int
    broken: bool
    """True if the file has unreadable lines, so that facts may be missing."""
    enum: bool
    there: bool = True
    """True if the requested commit declares it. Otherwise this is the content at the nearest commit that does."""


class Kind(Enum):
    """The kind of change between two usages of a number."""

    REUSED = "another message with other content"
    REPLACED = "a message of the same name with other content"
    RETYPED = "another type, which reads the bytes differently"
    MEANING = "another name, which shares no word with the old one"
    RENAMED = "the same meaning under another name"


class Relation(Enum):
    """The relation of two usages in the graph of commits."""

    SUCCESSION = "the later one was added after the earlier one was deleted, on one line of history"
    BRANCHES = "they were added on different branches"
    TOGETHER = "one commit declares both"


@dataclass(frozen=True, slots=True)
class Reuse:
    """Two usages of one number of a message or enum with different meanings."""

    owner: str
    """Full name of the message or enum."""
    number: int
    kind: Kind
    earlier: Usage
    later: Usage
    """The later usage; the same object as `earlier` if the content was replaced under the same name."""
    relation: Relation
    at_once: bool
    """True if both were in use at the same time, by the committers' clocks, even on different branches."""
    old: Content | None
    """The last content of the earlier type; None if it is not a message or enum, or is unknown."""
    new: Content | None
    """The first content of the later type."""
    survivors: int
    """The number of old fields that still exist in the new content."""
    confidence: Confidence

    @property
    def real(self) -> bool:
        """True if bytes of one are misread as the other. A mere rename is harmless."""
        return self.kind is not Kind.RENAMED


@dataclass(frozen=True, slots=True)
class Allocation:
    """A number that a branch has assigned since it left the default branch."""

    refs: tuple[str, ...]
    """The branches; several if they agree."""
    type: str
    name: str
    came: Commit
    path: str
    line: int


@dataclass(frozen=True, slots=True)
class Collision:
    """A number that separate branches have given to different payloads."""

    number: int
    allocations: tuple[Allocation, ...]
