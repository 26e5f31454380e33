"""The table mapping.yaml: the declarations of its keys, the reader of the file, and functions that change its text."""

from __future__ import annotations

from roverlink.generator.table.keys import (
    FORMAT_VERSION,
    LEARN,
    Bound,
    DeadmanSettings,
    EndSettings,
    EnumSettings,
    EnvelopeSettings,
    ForwardSettings,
    LinkSettings,
    Lowered,
    Numbered,
    PeerSettings,
    ProtoSettings,
    RequestSettings,
    RetiredRow,
    RosSettings,
    Row,
    SigningSettings,
    StandardTopicSettings,
    Table,
)
from roverlink.generator.table.parts import Form

__all__ = [
    "FORMAT_VERSION",
    "LEARN",
    "Bound",
    "DeadmanSettings",
    "EndSettings",
    "EnumSettings",
    "EnvelopeSettings",
    "ForwardSettings",
    "LinkSettings",
    "StandardTopicSettings",
    "Form",
    "Lowered",
    "PeerSettings",
    "RequestSettings",
    "ProtoSettings",
    "RetiredRow",
    "RosSettings",
    "Row",
    "SigningSettings",
    "Numbered",
    "Table",
]
