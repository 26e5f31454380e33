# Generated from mapping.yaml (row gps) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""gps (1): Gps to diagnostic_msgs/msg/DiagnosticStatus on gps/level."""

from __future__ import annotations

from generated.interfaces import diagnostic_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core.feed import UNSTAMPED, Counterparts, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_HEALTH = Counterparts(
    "health",
    {
        1: diagnostic_msgs.DiagnosticStatus.OK,  # GOOD
        2: diagnostic_msgs.DiagnosticStatus.ERROR,  # BAD
    },
)
_QUALITY = Counterparts(
    "quality",
    {
        0: "no fix",  # NONE
        1: "plain",  # PLAIN
        4: 'real "time"',  # RTK
    },
)
_HEALTH_BACK = _HEALTH.back("level")
_QUALITY_BACK = _QUALITY.back("message")


class GpsGpsLevelFeed(Feed[board_pb2.Gps, diagnostic_msgs.DiagnosticStatus]):
    """Gps to diagnostic_msgs/DiagnosticStatus on the topic gps/level."""

    route = Route(number=1, name="gps", topic="gps/level", direction="board_to_ros")
    payload_type = board_pb2.Gps
    message_type = diagnostic_msgs.DiagnosticStatus

    @staticmethod
    def to_ros(
        payload: board_pb2.Gps,
        _stamp: Time = UNSTAMPED,
    ) -> diagnostic_msgs.DiagnosticStatus:
        """The message that says what the payload says."""
        return diagnostic_msgs.DiagnosticStatus(
            level=_HEALTH.get(payload.health, diagnostic_msgs.DiagnosticStatus.STALE),
            name="gps",
            message=_QUALITY[payload.quality],
        )

    @staticmethod
    def from_ros(message: diagnostic_msgs.DiagnosticStatus) -> board_pb2.Gps:
        """The payload that says what the message says.

        It says nothing of latitude_e7, longitude_e7, altitude_cm.
        """
        return board_pb2.Gps(
            health=_HEALTH_BACK[message.level],
            quality=_QUALITY_BACK[message.message],
        )
