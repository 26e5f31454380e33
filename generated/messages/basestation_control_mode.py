# Generated from mapping.yaml (BasestationControlMode); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/BasestationControlMode."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message, UInt8


@dataclass(slots=True)
class BasestationControlMode(Message):
    """Choice of the driver: the operator or the rover itself."""

    __msgtype__: ClassVar[str] = "comms/msg/BasestationControlMode"
    __typehash__: ClassVar[str] = (
        "RIHS01_64d04f30aca396033115a377bb84263a86b3531099a9a6b20495cf59297be328"
    )

    # Values of mode
    MODE_MANUAL: ClassVar[int] = 0
    MODE_AUTO: ClassVar[int] = 1

    mode: UInt8 = 0
