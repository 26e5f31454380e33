# Generated from mapping.yaml (row report) and command.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row report: Report and rover/msg/Report."""

from __future__ import annotations

from generated.messages import Report
from generated.pb2 import command_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.core.handler import Handler, Route

WHICH_RESULT_MEMBERS = {
    "number": Report.RESULT_NUMBER,
    "text": Report.RESULT_TEXT,
}


class ReportHandler(Handler[command_pb2.Report, Report]):
    """Report as rover/msg/Report.

    Number 2 of the envelope, board_to_ros, topic report.
    """

    route = Route(
        number=2,
        name="report",
        topic="report",
        direction="board_to_ros",
    )
    payload_type = command_pb2.Report
    message_type = Report

    @staticmethod
    def to_ros(payload: command_pb2.Report) -> Report:
        """Convert Report to rover/msg/Report."""
        return Report(
            which_result=oneof.number(payload, "result", WHICH_RESULT_MEMBERS),
            number=payload.number,
            text=payload.text,
        )

    @staticmethod
    def from_ros(message: Report) -> command_pb2.Report:
        """Convert rover/msg/Report to Report."""
        which_result = oneof.member(
            message.which_result, WHICH_RESULT_MEMBERS, "which_result"
        )
        return command_pb2.Report(
            number=message.number if which_result == "number" else None,
            text=message.text if which_result == "text" else None,
        )
