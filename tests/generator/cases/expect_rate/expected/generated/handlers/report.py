# Generated from mapping.yaml (row report) and report.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row report: Report and probe_msgs/msg/Report."""

from __future__ import annotations

from generated.messages import Report
from generated.pb2 import report_pb2
from roverlink.runtime.core.handler import Handler, Route


class ReportHandler(Handler[report_pb2.Report, Report]):
    """Report as probe_msgs/msg/Report.

    Number 1 of the envelope, drill_to_ros, topic report.
    """

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
        """Convert Report to probe_msgs/msg/Report."""
        return Report(
            depth=payload.depth,
        )

    @staticmethod
    def from_ros(message: Report) -> report_pb2.Report:
        """Convert probe_msgs/msg/Report to Report."""
        return report_pb2.Report(
            depth=message.depth,
        )
