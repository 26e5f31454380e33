# Generated from mapping.yaml (row report) and report.proto; do not edit.
# Regenerate with: roverlink generate
"""report (1): Report to probe_msgs/msg/Report on report."""

from __future__ import annotations

from generated.messages import Report
from generated.pb2 import report_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(Report)


class ReportHandler(Handler[report_pb2.Report, Report]):
    """Report to the topic report."""

    route = Route(
        number=1,
        name="report",
        topic="report",
        direction="drill_to_ros",
        expect_rate=50,
    )
    payload_type = report_pb2.Report
    message_type = Report

    @staticmethod
    def to_ros(payload: report_pb2.Report) -> Report:
        """The message that says what the payload says."""
        return Report(depth=payload.depth)

    @staticmethod
    def from_ros(message: Report) -> report_pb2.Report:
        """The payload that says what the message says."""
        return report_pb2.Report(depth=message.depth)

    def pack(self, payload: report_pb2.Report) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.depth)
