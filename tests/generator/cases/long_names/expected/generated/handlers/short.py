# Generated from mapping.yaml (row short) and a_folder_with_a_long_name/another_folder_with_a_long_name/a_file_with_a_long_name.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row short: Short and rover/msg/Short."""

from __future__ import annotations

from generated.conversions import (
    a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_innermost,
)
from generated.messages import Short
from generated.pb2.a_folder_with_a_long_name.another_folder_with_a_long_name import (
    a_file_with_a_long_name_pb2,
)
from roverlink.runtime.core.handler import Handler, Route


class ShortHandler(Handler[a_file_with_a_long_name_pb2.Short, Short]):
    """Short as rover/msg/Short.

    Number 2 of the envelope, board_to_ros, topic short.
    """

    route = Route(
        number=2,
        name="short",
        topic="short",
        direction="board_to_ros",
    )
    payload_type = a_file_with_a_long_name_pb2.Short
    message_type = Short

    @staticmethod
    def to_ros(payload: a_file_with_a_long_name_pb2.Short) -> Short:
        """Convert Short to rover/msg/Short."""
        return Short(
            innermost_with_a_name_of_some_length=a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_innermost.to_ros(
                payload.innermost_with_a_name_of_some_length
            ),
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_doubles=payload.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_doubles,
            has_a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe=payload.HasField(
                "a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe"
            ),
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe=payload.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe,
            an_enum=payload.an_enum,
        )

    @staticmethod
    def from_ros(message: Short) -> a_file_with_a_long_name_pb2.Short:
        """Convert rover/msg/Short to Short."""
        return a_file_with_a_long_name_pb2.Short(
            innermost_with_a_name_of_some_length=a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_innermost.from_ros(
                message.innermost_with_a_name_of_some_length
            ),
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_doubles=message.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_doubles,
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe=(
                message.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe
                if message.has_a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe
                else None
            ),
            an_enum=message.an_enum,
        )
