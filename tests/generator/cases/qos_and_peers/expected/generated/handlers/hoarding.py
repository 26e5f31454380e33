# Generated from mapping.yaml (row hoarding) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""hoarding (5): E to rover/msg/E on ~/hoarding."""

from __future__ import annotations

from generated.messages import E
from generated.pb2 import all_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Qos, Route

_CDR = cdr.fixed_layout(E)


class HoardingHandler(Handler[all_pb2.E, E]):
    """E to the topic ~/hoarding."""

    route = Route(
        number=5,
        name="hoarding",
        topic="~/hoarding",
        direction="base_to_ros",
        qos=Qos(history="keep_all"),
    )
    payload_type = all_pb2.E
    message_type = E

    @staticmethod
    def to_ros(payload: all_pb2.E) -> E:
        """The message that says what the payload says."""
        return E(x=payload.x)

    @staticmethod
    def from_ros(message: E) -> all_pb2.E:
        """The payload that says what the message says."""
        return all_pb2.E(x=message.x)

    def pack(self, payload: all_pb2.E) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.x)
