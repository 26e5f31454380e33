"""Draft of a table: its facts and guesses, each with the reason for it."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(slots=True)
class DraftRow:
    """Draft of a row of the table."""

    number: int
    name: str
    proto: str
    comment: str
    """Comment of the member in the envelope."""
    peer: str
    inbound: bool
    doubt: str
    """Reason why the row's direction is a guess; empty if it is certain."""
    ros: str = ""
    """Name of the ROS message; empty if it is the name of the proto message."""
    fields: dict[str, str] = field(default_factory=dict)
    ignore: dict[str, str] = field(default_factory=dict)
    """Fields of the payload that cannot be converted; each name with the reason."""
    lint: dict[str, str] = field(default_factory=dict)
    """Ids of the rules whose severity is lowered for this row; each id with the reason."""

    @property
    def direction(self) -> str:
        """Direction as the table writes it: ``hardware_to_ros`` or ``ros_to_hardware``."""
        return f"{self.peer}_to_ros" if self.inbound else f"ros_to_{self.peer}"


@dataclass(slots=True)
class DraftPeer:
    """Draft of a peer."""

    name: str
    prefixes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class DraftRetired:
    """Number that the envelope used in the past, according to git's history, and does not use now."""

    number: int
    name: str
    proto: str
    note: str


@dataclass(slots=True)
class Draft:
    """Draft of the whole table."""

    root: str
    """Folder of the protos, relative to the table."""
    package: str
    file: str
    """File of the envelope, relative to the folder of the protos."""
    message: str
    oneof: str
    oneof_doubt: str
    """Reason why the choice of the envelope is a guess; empty if it is certain."""
    owner: str
    owner_reason: str
    exclude: dict[str, str]
    """Files that do not compile with the others; each path with the reason."""
    peers: list[DraftPeer]
    rows: list[DraftRow]
    retired: list[DraftRetired]
    lint: dict[str, str] = field(default_factory=dict)
    """Ids of the rules whose severity is lowered for the whole table; each id with the reason."""
