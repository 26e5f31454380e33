"""Reasons of an estimator on ``/diagnostics``."""

from __future__ import annotations

from roverkit.gating import Reasons
from roverkit.node.ros_connection import RosConnection
from roverkit.node.shared_topics import DIAGNOSTICS

from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray, DiagnosticStatus, KeyValue
from roverlink.runtime.interfaces.std_msgs import Header

_PERIOD_NS = 1_000_000_000
"""Time in nanoseconds between two messages."""


class ReasonDiagnostics:
    """Publisher of the reasons of one estimator."""

    def __init__(self, connection: RosConnection, reasons: Reasons) -> None:
        self._name, self._reasons = connection.arguments.node.full_name.lstrip("/"), reasons
        self._publisher = DIAGNOSTICS.publisher(connection.middleware, connection.topic)
        self._at: int | None = None

    def publish(self, now: int) -> None:
        """Publish the reasons if the last message is a second old; ``now`` is in nanoseconds."""
        if self._at is not None and 0 <= now - self._at < _PERIOD_NS:
            return
        self._at = now
        message = "; ".join(f"no {result}: {why}" for result, why in self._reasons.missing.items())
        level = DiagnosticStatus.WARN if message else DiagnosticStatus.OK
        counts = [KeyValue(reason, str(count)) for reason, count in self._reasons.counts.items()]
        array = DiagnosticArray(
            Header(Time.since_1970(now)), [DiagnosticStatus(level, self._name, message, "", counts)]
        )
        self._publisher.publish([cdr.encode(array)])
