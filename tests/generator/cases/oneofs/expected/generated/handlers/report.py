# Generated from mapping.yaml (row report) and command.proto; do not edit.
# Regenerate with: roverlink generate
"""report (2): Report to rover/msg/Report on report."""

from __future__ import annotations

from generated.messages import Report
from generated.pb2 import command_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.core.handler import Handler, Route

_WHICH_RESULT = {"number": Report.RESULT_NUMBER, "text": Report.RESULT_TEXT}


class ReportHandler(Handler[command_pb2.Report, Report]):
    """Report to the topic report."""

    route = Route(number=2, name="report", topic="report", direction="board_to_ros")
    payload_type = command_pb2.Report
    message_type = Report

    @staticmethod
    def to_ros(payload: command_pb2.Report) -> Report:
        """The message that says what the payload says."""
        return Report(
            which_result=oneof.number(payload, "result", _WHICH_RESULT),
            number=payload.number,
            text=payload.text,
        )

    @staticmethod
    def from_ros(message: Report) -> command_pb2.Report:
        """The payload that says what the message says."""
        which_result = oneof.member(message.which_result, _WHICH_RESULT, "which_result")
        return command_pb2.Report(
            number=message.number if which_result == "number" else None,
            text=message.text if which_result == "text" else None,
        )
