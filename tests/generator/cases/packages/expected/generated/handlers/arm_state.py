# Generated from mapping.yaml (row arm_state) and rover/arm/state.proto; do not edit.
# Regenerate with: roverlink generate
"""arm_state (1): State to rover/msg/ArmState on arm_state."""

from __future__ import annotations

from generated.conversions import common
from generated.handlers.inner import InnerHandler
from generated.handlers.top import TopHandler
from generated.messages import ArmKind, ArmState
from generated.pb2.rover.arm import state_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(ArmState)


class ArmStateHandler(Handler[state_pb2.State, ArmState]):
    """State to the topic arm_state."""

    route = Route(
        number=1,
        name="arm_state",
        topic="arm_state",
        direction="board_to_ros",
    )
    payload_type = state_pb2.State
    message_type = ArmState

    @staticmethod
    def to_ros(payload: state_pb2.State) -> ArmState:
        """The message that says what the payload says."""
        return ArmState(
            inner=InnerHandler.to_ros(payload.inner),
            common=common.to_ros(payload.common),
            top=TopHandler.to_ros(payload.top),
            kind=ArmKind(kind=payload.kind),
        )

    @staticmethod
    def from_ros(message: ArmState) -> state_pb2.State:
        """The payload that says what the message says."""
        return state_pb2.State(
            inner=InnerHandler.from_ros(message.inner),
            common=common.from_ros(message.common),
            top=TopHandler.from_ros(message.top),
            kind=message.kind.kind,
        )

    def pack(self, payload: state_pb2.State) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        inner = payload.inner
        common = payload.common
        top = payload.top
        return _CDR.pack(cdr.LITTLE_ENDIAN, inner.x, common.id, top.z, payload.kind)
