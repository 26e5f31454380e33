"""mapping.yaml: what it may hold, and the table that it is read as."""

from __future__ import annotations

from roverlink.generator.table.keys import (
    FORMAT_VERSION,
    IMPLEMENTATION_NUMBERS,
    LARGEST_NUMBER,
    Bound,
    DeadmanSettings,
    EnumSettings,
    EnvelopeSettings,
    FeedSettings,
    Lowered,
    PeerSettings,
    ProtoSettings,
    RetiredRow,
    RosSettings,
    Row,
    Table,
)
from roverlink.generator.table.parts import Form

__all__ = [
    "FORMAT_VERSION",
    "IMPLEMENTATION_NUMBERS",
    "LARGEST_NUMBER",
    "Bound",
    "DeadmanSettings",
    "EnumSettings",
    "EnvelopeSettings",
    "FeedSettings",
    "Form",
    "Lowered",
    "PeerSettings",
    "ProtoSettings",
    "RetiredRow",
    "RosSettings",
    "Row",
    "Table",
]
