# Generated from mapping.yaml (BasestationObjectSelection); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/BasestationObjectSelection."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message, UInt32


@dataclass(slots=True)
class BasestationObjectSelection(Message):
    """The object that the operator picked among the detected ones."""

    __msgtype__: ClassVar[str] = "comms/msg/BasestationObjectSelection"
    __typehash__: ClassVar[str] = (
        "RIHS01_c7ccaae8c714442183f90d89bd6f116229457abd65be82a4982497c21635922b"
    )

    object_id: UInt32 = 0
