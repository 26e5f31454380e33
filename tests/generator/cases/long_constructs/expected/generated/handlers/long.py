# Generated from mapping.yaml (row long) and long.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row long: Long and rover/msg/Long."""

from __future__ import annotations

from google.protobuf import empty_pb2, field_mask_pb2, wrappers_pb2

from generated.conversions import (
    a_message_with_a_name_that_is_so_long_that_nothing_else_fits_into_the_line_beside_it,
    long_an_any_field_with_a_name_so_long_that_nothing_fits_beside_it,
    short,
)
from generated.messages import (
    Bytes,
    Long,
    LongAMapFieldWithANameSoLongThatNothingFitsBesideItEntry,
    LongAMapOfTimesFieldWithANameSoLongThatNothingFitsBesideItEntry,
    LongAMapOfWrappersFieldWithANameSoLongThatNothingFitsBesideItEntry,
    LongAPlainMapFieldWithANameSoLongThatNothingFitsBesideItEntry,
    LongFinallyEntry,
)
from generated.pb2 import long_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.convert.keywords import keywords
from roverlink.runtime.convert.maps import mapping
from roverlink.runtime.convert.well_known import (
    duration,
    json_struct,
    json_value,
    timestamp,
)
from roverlink.runtime.core.handler import Handler, Route

WHICH_A_ONEOF_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT_MEMBERS = {
    "a_member_field_with_a_name_so_long_that_nothing_fits_beside_it": Long.A_ONEOF_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT_A_MEMBER_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT,
    "another_member_field_with_a_name_so_long_that_nothing_fits_beside_it": Long.A_ONEOF_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT_ANOTHER_MEMBER_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT,
    "time_member_field_with_a_name_so_long_that_nothing_fits_beside_it": Long.A_ONEOF_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT_TIME_MEMBER_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT,
    "wrapped_member_field_with_a_name_so_long_that_nothing_fits_beside_it": Long.A_ONEOF_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT_WRAPPED_MEMBER_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT,
    "value_member_field_with_a_name_so_long_that_nothing_fits_beside_it": Long.A_ONEOF_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT_VALUE_MEMBER_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT,
}


class LongHandler(Handler[long_pb2.Long, Long]):
    """Long as rover/msg/Long.

    Number 1 of the envelope, board_to_ros, topic long.
    """

    route = Route(
        number=1,
        name="long",
        topic="long",
        direction="board_to_ros",
    )
    payload_type = long_pb2.Long
    message_type = Long

    @staticmethod
    def to_ros(payload: long_pb2.Long) -> Long:
        """Convert Long to rover/msg/Long."""
        return Long(
            a_map_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                LongAMapFieldWithANameSoLongThatNothingFitsBesideItEntry(
                    key=key,
                    value=a_message_with_a_name_that_is_so_long_that_nothing_else_fits_into_the_line_beside_it.to_ros(
                        value
                    ),
                )
                for key, value in sorted(
                    payload.a_map_field_with_a_name_so_long_that_nothing_fits_beside_it.items()
                )
            ],
            a_map_of_times_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                LongAMapOfTimesFieldWithANameSoLongThatNothingFitsBesideItEntry(
                    key=key,
                    value=timestamp.to_ros(
                        value,
                        "a_map_of_times_field_with_a_name_so_long_that_nothing_fits_beside_it",
                    ),
                )
                for key, value in sorted(
                    payload.a_map_of_times_field_with_a_name_so_long_that_nothing_fits_beside_it.items()
                )
            ],
            a_plain_map_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                LongAPlainMapFieldWithANameSoLongThatNothingFitsBesideItEntry(
                    key=key, value=value
                )
                for key, value in sorted(
                    payload.a_plain_map_field_with_a_name_so_long_that_nothing_fits_beside_it.items()
                )
            ],
            a_map_of_wrappers_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                LongAMapOfWrappersFieldWithANameSoLongThatNothingFitsBesideItEntry(
                    key=key, value=value.value
                )
                for key, value in sorted(
                    payload.a_map_of_wrappers_field_with_a_name_so_long_that_nothing_fits_beside_it.items()
                )
            ],
            an_any_field_with_a_name_so_long_that_nothing_fits_beside_it=long_an_any_field_with_a_name_so_long_that_nothing_fits_beside_it.to_ros(
                payload.an_any_field_with_a_name_so_long_that_nothing_fits_beside_it
            ),
            has_a_wrapper_field_with_a_name_so_long_that_nothing_fits_beside_it=payload.HasField(
                "a_wrapper_field_with_a_name_so_long_that_nothing_fits_beside_it"
            ),
            a_wrapper_field_with_a_name_so_long_that_nothing_fits_beside_it=payload.a_wrapper_field_with_a_name_so_long_that_nothing_fits_beside_it.value,
            a_time_field_with_a_name_so_long_that_nothing_fits_beside_it=timestamp.to_ros(
                payload.a_time_field_with_a_name_so_long_that_nothing_fits_beside_it,
                "a_time_field_with_a_name_so_long_that_nothing_fits_beside_it",
            ),
            a_struct_field_with_a_name_so_long_that_nothing_fits_beside_it=(
                json_struct.to_ros(
                    payload.a_struct_field_with_a_name_so_long_that_nothing_fits_beside_it,
                    "a_struct_field_with_a_name_so_long_that_nothing_fits_beside_it",
                )
                if payload.HasField(
                    "a_struct_field_with_a_name_so_long_that_nothing_fits_beside_it"
                )
                else ""
            ),
            has_an_empty_field_with_a_name_so_long_that_nothing_fits_beside_it=payload.HasField(
                "an_empty_field_with_a_name_so_long_that_nothing_fits_beside_it"
            ),
            durations_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                duration.to_ros(
                    item,
                    "durations_field_with_a_name_so_long_that_nothing_fits_beside_it",
                )
                for item in payload.durations_field_with_a_name_so_long_that_nothing_fits_beside_it
            ],
            wrappers_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                item.value
                for item in payload.wrappers_field_with_a_name_so_long_that_nothing_fits_beside_it
            ],
            parts_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                Bytes(data=item)
                for item in payload.parts_field_with_a_name_so_long_that_nothing_fits_beside_it
            ],
            mask_field_with_a_name_so_long_that_nothing_fits_beside_it=list(
                payload.mask_field_with_a_name_so_long_that_nothing_fits_beside_it.paths
            ),
            messages_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                a_message_with_a_name_that_is_so_long_that_nothing_else_fits_into_the_line_beside_it.to_ros(
                    item
                )
                for item in payload.messages_field_with_a_name_so_long_that_nothing_fits_beside_it
            ],
            class_field=getattr(payload, "class"),
            try_field=short.to_ros(getattr(payload, "try")),
            finally_field=[
                LongFinallyEntry(key=key, value=short.to_ros(value))
                for key, value in sorted(getattr(payload, "finally").items())
            ],
            which_a_oneof_field_with_a_name_so_long_that_nothing_fits_beside_it=oneof.number(
                payload,
                "a_oneof_field_with_a_name_so_long_that_nothing_fits_beside_it",
                WHICH_A_ONEOF_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT_MEMBERS,
            ),
            a_member_field_with_a_name_so_long_that_nothing_fits_beside_it=payload.a_member_field_with_a_name_so_long_that_nothing_fits_beside_it,
            another_member_field_with_a_name_so_long_that_nothing_fits_beside_it=a_message_with_a_name_that_is_so_long_that_nothing_else_fits_into_the_line_beside_it.to_ros(
                payload.another_member_field_with_a_name_so_long_that_nothing_fits_beside_it
            ),
            time_member_field_with_a_name_so_long_that_nothing_fits_beside_it=timestamp.to_ros(
                payload.time_member_field_with_a_name_so_long_that_nothing_fits_beside_it,
                "time_member_field_with_a_name_so_long_that_nothing_fits_beside_it",
            ),
            wrapped_member_field_with_a_name_so_long_that_nothing_fits_beside_it=payload.wrapped_member_field_with_a_name_so_long_that_nothing_fits_beside_it.value,
            value_member_field_with_a_name_so_long_that_nothing_fits_beside_it=(
                json_value.to_ros(
                    payload.value_member_field_with_a_name_so_long_that_nothing_fits_beside_it,
                    "value_member_field_with_a_name_so_long_that_nothing_fits_beside_it",
                )
                if payload.HasField(
                    "value_member_field_with_a_name_so_long_that_nothing_fits_beside_it"
                )
                else ""
            ),
        )

    @staticmethod
    def from_ros(message: Long) -> long_pb2.Long:
        """Convert rover/msg/Long to Long."""
        which_a_oneof_field_with_a_name_so_long_that_nothing_fits_beside_it = oneof.member(
            message.which_a_oneof_field_with_a_name_so_long_that_nothing_fits_beside_it,
            WHICH_A_ONEOF_FIELD_WITH_A_NAME_SO_LONG_THAT_NOTHING_FITS_BESIDE_IT_MEMBERS,
            "which_a_oneof_field_with_a_name_so_long_that_nothing_fits_beside_it",
        )
        return long_pb2.Long(
            a_map_field_with_a_name_so_long_that_nothing_fits_beside_it=mapping(
                (
                    (
                        item.key,
                        a_message_with_a_name_that_is_so_long_that_nothing_else_fits_into_the_line_beside_it.from_ros(
                            item.value
                        ),
                    )
                    for item in message.a_map_field_with_a_name_so_long_that_nothing_fits_beside_it
                ),
                "a_map_field_with_a_name_so_long_that_nothing_fits_beside_it",
            ),
            a_map_of_times_field_with_a_name_so_long_that_nothing_fits_beside_it=mapping(
                (
                    (
                        item.key,
                        timestamp.from_ros(
                            item.value,
                            "a_map_of_times_field_with_a_name_so_long_that_nothing_fits_beside_it",
                        ),
                    )
                    for item in message.a_map_of_times_field_with_a_name_so_long_that_nothing_fits_beside_it
                ),
                "a_map_of_times_field_with_a_name_so_long_that_nothing_fits_beside_it",
            ),
            a_plain_map_field_with_a_name_so_long_that_nothing_fits_beside_it=mapping(
                (
                    (item.key, item.value)
                    for item in message.a_plain_map_field_with_a_name_so_long_that_nothing_fits_beside_it
                ),
                "a_plain_map_field_with_a_name_so_long_that_nothing_fits_beside_it",
            ),
            a_map_of_wrappers_field_with_a_name_so_long_that_nothing_fits_beside_it=mapping(
                (
                    (item.key, wrappers_pb2.FloatValue(value=item.value))
                    for item in message.a_map_of_wrappers_field_with_a_name_so_long_that_nothing_fits_beside_it
                ),
                "a_map_of_wrappers_field_with_a_name_so_long_that_nothing_fits_beside_it",
            ),
            an_any_field_with_a_name_so_long_that_nothing_fits_beside_it=long_an_any_field_with_a_name_so_long_that_nothing_fits_beside_it.from_ros(
                message.an_any_field_with_a_name_so_long_that_nothing_fits_beside_it
            ),
            a_wrapper_field_with_a_name_so_long_that_nothing_fits_beside_it=(
                wrappers_pb2.FloatValue(
                    value=message.a_wrapper_field_with_a_name_so_long_that_nothing_fits_beside_it
                )
                if message.has_a_wrapper_field_with_a_name_so_long_that_nothing_fits_beside_it
                else None
            ),
            a_time_field_with_a_name_so_long_that_nothing_fits_beside_it=timestamp.from_ros(
                message.a_time_field_with_a_name_so_long_that_nothing_fits_beside_it,
                "a_time_field_with_a_name_so_long_that_nothing_fits_beside_it",
            ),
            a_struct_field_with_a_name_so_long_that_nothing_fits_beside_it=(
                json_struct.from_ros(
                    message.a_struct_field_with_a_name_so_long_that_nothing_fits_beside_it,
                    "a_struct_field_with_a_name_so_long_that_nothing_fits_beside_it",
                )
                if message.a_struct_field_with_a_name_so_long_that_nothing_fits_beside_it
                else None
            ),
            an_empty_field_with_a_name_so_long_that_nothing_fits_beside_it=(
                empty_pb2.Empty()
                if message.has_an_empty_field_with_a_name_so_long_that_nothing_fits_beside_it
                else None
            ),
            durations_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                duration.from_ros(
                    item,
                    "durations_field_with_a_name_so_long_that_nothing_fits_beside_it",
                )
                for item in message.durations_field_with_a_name_so_long_that_nothing_fits_beside_it
            ],
            wrappers_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                wrappers_pb2.FloatValue(value=item)
                for item in message.wrappers_field_with_a_name_so_long_that_nothing_fits_beside_it
            ],
            parts_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                item.data
                for item in message.parts_field_with_a_name_so_long_that_nothing_fits_beside_it
            ],
            mask_field_with_a_name_so_long_that_nothing_fits_beside_it=field_mask_pb2.FieldMask(
                paths=message.mask_field_with_a_name_so_long_that_nothing_fits_beside_it
            ),
            messages_field_with_a_name_so_long_that_nothing_fits_beside_it=[
                a_message_with_a_name_that_is_so_long_that_nothing_else_fits_into_the_line_beside_it.from_ros(
                    item
                )
                for item in message.messages_field_with_a_name_so_long_that_nothing_fits_beside_it
            ],
            a_member_field_with_a_name_so_long_that_nothing_fits_beside_it=(
                message.a_member_field_with_a_name_so_long_that_nothing_fits_beside_it
                if which_a_oneof_field_with_a_name_so_long_that_nothing_fits_beside_it
                == "a_member_field_with_a_name_so_long_that_nothing_fits_beside_it"
                else None
            ),
            another_member_field_with_a_name_so_long_that_nothing_fits_beside_it=(
                a_message_with_a_name_that_is_so_long_that_nothing_else_fits_into_the_line_beside_it.from_ros(
                    message.another_member_field_with_a_name_so_long_that_nothing_fits_beside_it
                )
                if which_a_oneof_field_with_a_name_so_long_that_nothing_fits_beside_it
                == "another_member_field_with_a_name_so_long_that_nothing_fits_beside_it"
                else None
            ),
            time_member_field_with_a_name_so_long_that_nothing_fits_beside_it=(
                timestamp.from_ros(
                    message.time_member_field_with_a_name_so_long_that_nothing_fits_beside_it,
                    "time_member_field_with_a_name_so_long_that_nothing_fits_beside_it",
                )
                if which_a_oneof_field_with_a_name_so_long_that_nothing_fits_beside_it
                == "time_member_field_with_a_name_so_long_that_nothing_fits_beside_it"
                else None
            ),
            wrapped_member_field_with_a_name_so_long_that_nothing_fits_beside_it=(
                wrappers_pb2.FloatValue(
                    value=message.wrapped_member_field_with_a_name_so_long_that_nothing_fits_beside_it
                )
                if which_a_oneof_field_with_a_name_so_long_that_nothing_fits_beside_it
                == "wrapped_member_field_with_a_name_so_long_that_nothing_fits_beside_it"
                else None
            ),
            value_member_field_with_a_name_so_long_that_nothing_fits_beside_it=(
                json_value.from_ros(
                    message.value_member_field_with_a_name_so_long_that_nothing_fits_beside_it,
                    "value_member_field_with_a_name_so_long_that_nothing_fits_beside_it",
                )
                if which_a_oneof_field_with_a_name_so_long_that_nothing_fits_beside_it
                == "value_member_field_with_a_name_so_long_that_nothing_fits_beside_it"
                else None
            ),
            **keywords(
                {
                    "class": message.class_field,
                    "try": short.from_ros(message.try_field),
                    "finally": mapping(
                        (
                            (item.key, short.from_ros(item.value))
                            for item in message.finally_field
                        ),
                        "finally_field",
                    ),
                }
            ),
        )
