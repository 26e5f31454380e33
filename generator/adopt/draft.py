"""Draft of a mapping.yaml as data: its facts and guesses, with reasons that become comments in the file."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(slots=True)
class DraftRow:
    """Draft of one row of mapping.yaml: a payload with its ROS message, peer and direction."""

    number: int
    name: str
    proto: str
    comment: str
    """Comment of the payload's field in the envelope's .proto file."""
    peer: str
    inbound: bool
    """True if the peer sends the message to ROS 2; False if ROS 2 sends it to the peer."""
    doubt: str
    """Reason why the row's direction is a guess; empty if it is certain."""
    ros: str = ""
    """Name of the ROS message; empty if it is the name of the proto message."""
    fields: dict[str, str] = field(default_factory=dict)
    """Renamed fields: the name of each proto field with the name of its ROS field."""
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
    """Draft of a peer: a machine that exchanges messages with ROS 2."""

    name: str
    prefixes: tuple[str, ...]
    """First words of the names of the peer's messages, such as ``SensorBoard``; empty if none are known."""


@dataclass(frozen=True, slots=True)
class DraftRetired:
    """Draft of an entry under `retired`: a field number that the envelope used in the past and does not use now."""

    number: int
    name: str
    proto: str
    note: str
    """Comment for the table, such as the last commit that used the number; empty if there is none."""


@dataclass(slots=True)
class Draft:
    """Draft of the whole mapping.yaml."""

    root: str
    """Folder of the .proto files, relative to the folder of mapping.yaml."""
    package: str
    file: str
    """The envelope's .proto file, relative to `root`."""
    message: str
    oneof: str
    oneof_doubt: str
    """Reason why the choice of the envelope is a guess; empty if it is certain."""
    owner: str
    """``mapping`` if `roverlink generate` writes the envelope's file, ``proto`` if it only checks the file."""
    owner_reason: str
    exclude: dict[str, str]
    """Files that do not compile with the others; each path with the reason."""
    peers: list[DraftPeer]
    rows: list[DraftRow]
    retired: list[DraftRetired]
    lint: dict[str, str] = field(default_factory=dict)
    """Ids of the rules whose severity is lowered for the whole table; each id with the reason."""
