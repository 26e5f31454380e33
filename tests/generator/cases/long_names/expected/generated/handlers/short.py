# Generated from mapping.yaml (row short) and a_folder_with_a_long_name/another_folder_with_a_long_name/a_file_with_a_long_name.proto; do not edit.
# Regenerate with: roverlink generate
"""short (2): Short to rover/msg/Short on short."""

from __future__ import annotations

from generated.conversions import (
    a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_innermost,
)
from generated.messages import Short
from generated.pb2.a_folder_with_a_long_name.another_folder_with_a_long_name import (
    a_file_with_a_long_name_pb2,
)
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(Short)


class ShortHandler(Handler[a_file_with_a_long_name_pb2.Short, Short]):
    """Short to the topic short."""

    route = Route(number=2, name="short", topic="short", direction="board_to_ros")
    payload_type = a_file_with_a_long_name_pb2.Short
    message_type = Short

    @staticmethod
    def to_ros(payload: a_file_with_a_long_name_pb2.Short) -> Short:
        """The message that says what the payload says."""
        return Short(
            innermost_with_a_name_of_some_length=a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_innermost.to_ros(
                payload.innermost_with_a_name_of_some_length,
            ),
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_doubles=payload.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_doubles,
            has_a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe=payload.HasField(
                "a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe",
            ),
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe=payload.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe,
            an_enum=payload.an_enum,
        )

    @staticmethod
    def from_ros(message: Short) -> a_file_with_a_long_name_pb2.Short:
        """The payload that says what the message says."""
        return a_file_with_a_long_name_pb2.Short(
            innermost_with_a_name_of_some_length=a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_innermost.from_ros(
                message.innermost_with_a_name_of_some_length,
            ),
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_doubles=message.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_doubles,
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe=(
                message.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe
                if message.has_a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe
                else None
            ),
            an_enum=message.an_enum,
        )

    def pack(self, payload: a_file_with_a_long_name_pb2.Short) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        innermost_with_a_name_of_some_length = payload.innermost_with_a_name_of_some_length  # fmt: skip
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            innermost_with_a_name_of_some_length.x,
            payload.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_doubles,
            payload.HasField(
                "a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe",
            ),
            payload.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_maybe,
            payload.an_enum,
        )
