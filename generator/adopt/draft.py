"""Draft of a table: facts and guesses, with the reasons."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(slots=True)
class DraftRow:
    """Draft of a row."""

    number: int
    name: str
    proto: str
    comment: str
    """Comment of the member in the envelope."""
    peer: str
    inbound: bool
    doubt: str
    """Reason why the direction is a guess; empty if it is certain."""
    ros: str = ""
    """Name of the ROS message, if it differs from the proto's."""
    fields: dict[str, str] = field(default_factory=dict)
    ignore: dict[str, str] = field(default_factory=dict)
    """Fields that cannot be converted, with the reasons."""
    lint: dict[str, str] = field(default_factory=dict)
    """Rules with a lower severity for this row, with the reasons."""

    @property
    def direction(self) -> str:
        """Direction as the table spells it."""
        return f"{self.peer}_to_ros" if self.inbound else f"ros_to_{self.peer}"


@dataclass(slots=True)
class DraftPeer:
    """Draft of a peer."""

    name: str
    prefixes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class DraftRetired:
    """Number that was used before, by git's history."""

    number: int
    name: str
    proto: str
    note: str


@dataclass(slots=True)
class Draft:
    """Draft of the table."""

    root: str
    """Folder of the protos, relative to the table."""
    package: str
    file: str
    """File of the envelope."""
    message: str
    oneof: str
    oneof_doubt: str
    """Reason why envelope and oneof are guesses; empty if they are certain."""
    owner: str
    owner_reason: str
    exclude: dict[str, str]
    """Files that do not compile with the others, with the reasons."""
    peers: list[DraftPeer]
    rows: list[DraftRow]
    retired: list[DraftRetired]
    lint: dict[str, str] = field(default_factory=dict)
    """Rules with a lower severity, with the reasons."""
