"""Exceptions of this package, grouped by cause: our own setup, a datagram of a peer, or a value that does not fit."""

from __future__ import annotations

from enum import Enum

from roverlink.suggestions import nearest as nearest


class RoverlinkError(Exception):
    """Base class of all exceptions that this package raises on purpose."""


class RegistryError(RoverlinkError):
    """Error of the generated code: it is missing, is not importable, or does not match the protobuf descriptors.

    The program cannot start. Most often `roverlink generate` solves the problem.
    """


class SetupError(RoverlinkError):
    """Problem that the user has to solve before the program can work, such as a port in use or a missing file."""


class MiddlewareError(RoverlinkError):
    """Error of a ROS 2 middleware, or a middleware that is not installed."""


class FailedThreadError(RoverlinkError):
    """Error that ended a thread of the program. The program ends, because it must not go on half alive."""

    def __init__(self, thread: str, failure: BaseException) -> None:
        """Create the error; ``thread`` is the name of the thread, and ``failure`` what it raised."""
        reason = str(failure)
        if not isinstance(failure, RoverlinkError):
            reason = f"{type(failure).__name__}: {reason} (ROVERLINK_DEBUG=1 shows where)"
        super().__init__(f"the program ends because its thread {thread} failed: {' '.join(reason.split())}")
        self.__cause__ = failure


class ConversionError(RoverlinkError):
    """Value that does not fit the type to which it is converted.

    Such a value is never changed silently to the nearest value that fits. ``field`` is the dotted path of the field in
    the message; it is empty if the field is unknown.
    """

    def __init__(self, message: str, field: str = "") -> None:
        super().__init__(f"{field}: {message}" if field else message)
        self.field = field


class Reason(str, Enum):
    """Reason why a received datagram was not published on a topic. The bridge counts dropped datagrams by reason."""

    EMPTY = "empty"
    """The envelope has no payload."""
    OVERSIZED = "oversized"
    """The datagram is longer than the parameter ``max_datagram`` allows."""
    MALFORMED = "malformed"
    """The bytes are not a valid envelope."""
    UNKNOWN_PAYLOAD = "unknown_payload"
    """The table has no row for the payload."""
    WRONG_DIRECTION = "wrong_direction"
    """The payload goes only from ROS 2 to a peer, but a peer has sent it."""
    CONVERSION = "conversion"
    """A value of the payload does not fit the ROS 2 message."""
    NOT_PUBLISHED = "not_published"
    """The middleware did not accept the message: a subscriber is too slow, or ROS 2 cannot publish it."""
    SUPERSEDED = "superseded"
    """A newer message replaced the message while it waited (table key ``max_rate``)."""
    UNKNOWN_SOURCE = "unknown_source"
    """No peer has the sender's address (table key ``sources``)."""
    WRONG_SOURCE = "wrong_source"
    """The payload belongs to another peer than the sender's address."""
    OVER_RATE = "over_rate"
    """The sender sends more datagrams a second than the table allows (table key ``source_rate``)."""
    UNSIGNED = "unsigned"
    """The peer must sign (table key ``sign``), and the datagram has no signature."""
    MALFORMED_SIGNATURE = "malformed_signature"
    """The signature has a wrong length, or is not the last field of the datagram."""
    UNKNOWN_KEY = "unknown_key"
    """No key file has the key with which the datagram is signed."""
    WRONG_SIGNATURE = "wrong_signature"
    """The datagram was changed, or was signed with another key of the same id."""
    WRONG_KEY = "wrong_key"
    """The datagram is signed with the key of another peer or board than its payload's."""
    REPLAYED = "replayed"
    """A signed datagram with the same timestamp was accepted before."""
    OUTDATED = "outdated"
    """A newer signed datagram of the same sender was accepted before."""
    AHEAD = "ahead"
    """The timestamp of the signature is more than ten years ahead of the computer's clock."""
    OTHER_SCHEMA = "other_schema"
    """The peer has another schema of the payload than the bridge (parameter ``link_policy``)."""
    REPEATED = "repeated"
    """The same request or response has come before (table key ``request``)."""
    STOPPED = "stopped"
    """The bridge stopped before it could handle the datagram."""


NOT_PROVEN = frozenset(
    {
        Reason.UNSIGNED,
        Reason.MALFORMED_SIGNATURE,
        Reason.UNKNOWN_KEY,
        Reason.WRONG_SIGNATURE,
        Reason.WRONG_KEY,
        Reason.REPLAYED,
        Reason.OUTDATED,
        Reason.AHEAD,
    }
)
"""Reasons of datagrams that anybody may have sent, so that they say nothing about the peer of their row."""


class DatagramError(RoverlinkError):
    """Error that concerns one datagram only, which is therefore not published on a topic, or not replayed.

    It does not end the program: the bridge counts the datagram as dropped and continues.
    """

    def __init__(self, reason: Reason, message: str, row: str = "") -> None:
        """Create the error; ``row`` is the name of the payload's row, such as ``imu_info``, or empty if unknown."""
        super().__init__(message)
        self.reason, self.row = reason, row
