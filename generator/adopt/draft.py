"""A table before it is written: what is known, what was guessed, and why."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(slots=True)
class DraftRow:
    """A row."""

    number: int
    name: str
    proto: str
    comment: str
    """What the envelope says of it."""
    peer: str
    inbound: bool
    doubt: str
    """Why the direction is a guess; empty where it is none."""
    ros: str = ""
    """The ROS message's name, where it cannot be the proto's."""
    fields: dict[str, str] = field(default_factory=dict)
    ignore: dict[str, str] = field(default_factory=dict)
    """Fields that cannot be converted, each with the reason."""
    lint: dict[str, str] = field(default_factory=dict)
    """Rules that count for less in what is about this row, each with the reason."""

    @property
    def direction(self) -> str:
        """As the table spells it."""
        return f"{self.peer}_to_ros" if self.inbound else f"ros_to_{self.peer}"


@dataclass(slots=True)
class DraftPeer:
    """A peer."""

    name: str
    prefixes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class DraftRetired:
    """A number that history shows was used."""

    number: int
    name: str
    proto: str
    note: str


@dataclass(slots=True)
class Draft:
    """The table."""

    root: str
    """Folder of the protos, relative to the table."""
    package: str
    file: str
    """The envelope's."""
    message: str
    oneof: str
    oneof_doubt: str
    """Why envelope and oneof are guesses; empty where they are none."""
    owner: str
    owner_reason: str
    exclude: dict[str, str]
    """Files that cannot be compiled with the others, each with the reason."""
    peers: list[DraftPeer]
    rows: list[DraftRow]
    retired: list[DraftRetired]
    lint: dict[str, str] = field(default_factory=dict)
    """Rules that count for less, each with the reason."""
