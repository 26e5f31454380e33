# Generated from mapping.yaml (row latched) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""latched (4): D from rover/msg/D on /latched."""

from __future__ import annotations

from generated.messages import D
from generated.pb2 import all_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Qos, Route

_CDR = cdr.fixed_layout(D)


class LatchedHandler(Handler[all_pb2.D, D]):
    """D from the topic /latched."""

    route = Route(
        number=4,
        name="latched",
        topic="/latched",
        direction="ros_to_base",
        qos=Qos(durability="transient_local"),
    )
    payload_type = all_pb2.D
    message_type = D

    @staticmethod
    def to_ros(payload: all_pb2.D) -> D:
        """The message that says what the payload says."""
        return D(x=payload.x)

    @staticmethod
    def from_ros(message: D) -> all_pb2.D:
        """The payload that says what the message says."""
        return all_pb2.D(x=message.x)

    def pack(self, payload: all_pb2.D) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.x)
