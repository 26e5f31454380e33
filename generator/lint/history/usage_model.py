"""The result types of the history: usages (meanings) of numbers, contents of messages, and changes of meaning."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from enum import Enum

from roverlink.generator.git import Commit
from roverlink.generator.protos.schema import Fact


@dataclass(frozen=True, slots=True)
class Interval:
    """The time from the commit that added a fact (a field or enum value) to the commits that deleted the fact."""

    came: Commit
    went: tuple[Commit, ...]
    """The commits that deleted the fact: none if it still exists, several if branches deleted it separately."""
    path: str
    """The file in which the fact was added, relative to the folder whose history was read."""
    line: int


@dataclass(frozen=True, slots=True)
class Usage:
    """One meaning of a number in the whole history.

    A declaration that was deleted and put back is one usage.
    """

    number: int
    type: str
    """The type as the .proto file writes it; empty for an enum value."""
    name: str
    label: str
    oneof: str
    json_name: str
    """The field's name in JSON by its option ``json_name``; empty if it has the usual one."""
    intervals: tuple[Interval, ...]
    """The times during which the fact existed, the earliest first."""
    live_at: tuple[str, ...]
    """The local and remote branches that contain the fact today."""
    went: Commit | None
    """The last commit that deleted the fact; None if a branch still contains it."""
    broken: bool
    """True if every file from which the fact was read has lines that cannot be read."""

    @property
    def came(self) -> Commit:
        """The commit that first added the fact."""
        return self.intervals[0].came

    @property
    def path(self) -> str:
        """The file to which the fact was first added."""
        return self.intervals[0].path

    @property
    def line(self) -> int:
        """The line at which the fact was first added."""
        return self.intervals[0].line

    @property
    def fact(self) -> Fact:
        """Declaration of the field or enum value that has the number, such as ``ImuInfo imu_info = 3``."""
        return Fact(self.number, self.name, self.type, self.label, self.oneof, json_name=self.json_name)


@dataclass(frozen=True, slots=True)
class TracedType:
    """A message or enum, which was followed through the history: through moved files, packages and renames."""

    id: int
    names: tuple[str, ...]
    """The full names that the type had: that of the newest state first, or the last one if it does not exist now."""
    enum: bool
    exists: bool
    """True if the newest state declares the type."""

    @property
    def name(self) -> str:
        """The full name of the type in the newest state, or its last full name."""
        return self.names[0]


@dataclass(frozen=True, slots=True)
class Content:
    """The fields of a message, or the values of an enum, at a commit."""

    id: int
    """Id of the message or enum, which stays the same if it is renamed."""
    type: str
    """Full name of the message or enum."""
    commit: Commit
    facts: tuple[Fact, ...]
    """The fields or values as facts, sorted by number."""
    path: str
    line: int
    broken: bool
    """True if the parser could not read some lines of the file, so that facts may be missing."""
    enum: bool
    there: bool = True
    """True if the type is declared at the requested commit.

    If not, this is the content at the nearest commit that declares the type.
    """

    @property
    def digest(self) -> str:
        """A short text that only contents with the same fields or values have."""
        # The ledger stores it. So attributes that later versions add to facts must not change it.
        facts = [(fact.number, fact.name, fact.type, fact.label) for fact in self.facts]
        return hashlib.sha256(repr(facts).encode()).hexdigest()[:8]


class Kind(Enum):
    """The kind of a change of meaning between two usages (meanings) of a number."""

    REUSED = "another message with other content"
    REPLACED = "a message of the same name with other content"
    RETYPED = "another type, which reads the bytes differently"
    MEANING = "another name, which means something else"
    UNIT = "another name with another unit, scale or reference"
    DOUBTFUL = "another name, which may mean something else"
    RENAMED = "the same meaning under another name"


class Relation(Enum):
    """The relation in time of two usages (meanings) of a number, according to the graph of commits."""

    SUCCESSION = "the later one was added after the earlier one was deleted, on one line of history"
    BRANCHES = "they were added on different branches"
    TOGETHER = "one commit declares both"


@dataclass(frozen=True, slots=True)
class Reuse:
    """A change of meaning: two different usages of one number in one message or enum."""

    owner: str
    """Full name of the message or enum."""
    number: int
    kind: Kind
    earlier: Usage
    later: Usage
    """The later usage. It is the same object as `earlier` if a message kept its name, and its content was replaced."""
    relation: Relation
    old: Content | None
    """The last content of the earlier usage's type; None if the type is no message or enum, or is unknown."""
    new: Content | None
    """The first content of the later usage's type; None if the type is no message or enum, or is unknown."""
    reason: str = ""
    """Why the meaning is another one, as a clause; empty for a mere rename."""
    same_as_earlier: frozenset[Usage] = frozenset()
    """The usages with the meaning of `earlier` under other names, which mere renames link with it."""
    same_as_later: frozenset[Usage] = frozenset()
    """The usages with the meaning of `later` under other names."""
    elsewhere: bool = False
    """True if only branches that are not merged gave the number one of the meanings."""
    unmerged: bool = False
    """True if the reuse is `elsewhere`, and may still be changed there.

    False if the state that is judged has one of the meanings, and an unmerged branch has the other one today.
    """

    naming: tuple[Commit, ...] = ()
    """The commits that gave one full name to the types with the two meanings; empty if one type has both."""

    @property
    def certain(self) -> bool:
        """True if bytes with the earlier meaning are misread with the later one."""
        return self.kind not in (Kind.RENAMED, Kind.UNIT, Kind.DOUBTFUL)

    @property
    def unbuilt(self) -> bool:
        """True if only files with syntax errors had one of the meanings, so that no program was built with it."""
        return self.earlier.broken or self.later.broken


@dataclass(frozen=True, slots=True)
class Allocation:
    """A field or enum value to which branches have given a number since they diverged."""

    refs: tuple[str, ...]
    """The branches that gave the number to this field or enum value."""
    type: str
    """The type of the field as the .proto file writes it; empty for an enum value."""
    name: str
    came: Commit
    path: str
    line: int


@dataclass(frozen=True, slots=True)
class Collision:
    """A number of a message or enum that branches have given to different things since they diverged."""

    owner: str
    """Full name of the message or enum."""
    number: int
    allocations: tuple[Allocation, ...]
    certain: bool
    """False if all allocations perhaps mean the same."""
    reason: str
    """Why two of the allocations do not mean the same, as a clause."""
    naming: tuple[Commit, ...]
    """The commits that gave `owner` to several types as their full name; empty if it is one type."""
