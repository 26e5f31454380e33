# Generated from mapping.yaml (row a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line) and a_folder_with_a_long_name/another_folder_with_a_long_name/a_file_with_a_long_name.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line: AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine and rover/msg/AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine."""

from __future__ import annotations

from generated.conversions import (
    a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_inner,
)
from generated.messages import (
    AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine,
    AnEnumMessageWithANameOfSomeLength,
)
from generated.pb2.a_folder_with_a_long_name.another_folder_with_a_long_name import (
    a_file_with_a_long_name_pb2,
)
from roverlink.runtime.core.handler import Handler, Qos, Route


class ANameThatIsSoLongThatTwoOfThemNeverFitIntoOneLineHandler(
    Handler[
        a_file_with_a_long_name_pb2.AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine,
        AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine,
    ]
):
    """AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine as rover/msg/AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine.

    Number 1 of the envelope, a_peer_whose_name_is_long_to_ros, topic a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line/a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line.
    """

    route = Route(
        number=1,
        name="a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line",
        topic="a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line/a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line",
        direction="a_peer_whose_name_is_long_to_ros",
        qos=Qos(
            reliability="best_effort",
            durability="transient_local",
            history="keep_all",
            depth=1000,
        ),
        forward=(
            "another_peer_whose_name_is_long",
            "yet_another_peer_whose_name_is_long",
            "board",
        ),
    )
    payload_type = (
        a_file_with_a_long_name_pb2.AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine
    )
    message_type = AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine

    @staticmethod
    def to_ros(
        payload: a_file_with_a_long_name_pb2.AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine,
    ) -> AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine:
        """Convert AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine to rover/msg/AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine."""
        return AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine(
            value_with_a_name_of_some_length=payload.nested_in_a_field_with_a_long_name.taken_apart.value_with_a_name_of_some_length,
            values_of_a_list_with_a_name_of_some_length=list(
                payload.nested_in_a_field_with_a_long_name.taken_apart.values
            ),
            has_maybe_with_a_name_that_is_very_long_indeed=payload.nested_in_a_field_with_a_long_name.taken_apart.HasField(
                "maybe_with_a_name"
            ),
            maybe_with_a_name_that_is_very_long_indeed=payload.nested_in_a_field_with_a_long_name.taken_apart.maybe_with_a_name,
            inner_with_a_name_that_is_very_long_indeed=a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_inner.to_ros(
                payload.nested_in_a_field_with_a_long_name.taken_apart.inner
            ),
            inners_with_a_name_that_is_very_long_indeed=[
                a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_inner.to_ros(
                    item
                )
                for item in payload.nested_in_a_field_with_a_long_name.taken_apart.inners
            ],
            has_a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line=payload.HasField(
                "a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line"
            ),
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line=payload.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line,
            has_an_optional_mode_with_a_name_that_is_long=payload.HasField(
                "an_optional_mode_with_a_name_that_is_long"
            ),
            an_optional_mode_with_a_name_that_is_long=AnEnumMessageWithANameOfSomeLength(
                value_of_the_mode=payload.an_optional_mode_with_a_name_that_is_long
            ),
            repeated_modes_with_a_name_that_is_long=[
                AnEnumMessageWithANameOfSomeLength(value_of_the_mode=item)
                for item in payload.repeated_modes_with_a_name_that_is_long
            ],
            inner_with_a_name_of_some_length=a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_inner.to_ros(
                payload.inner_with_a_name_of_some_length
            ),
            inners_with_a_name_of_some_length=[
                a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_inner.to_ros(
                    item
                )
                for item in payload.inners_with_a_name_of_some_length
            ],
            has_optional_inner_with_a_name_of_some_length=payload.HasField(
                "optional_inner_with_a_name_of_some_length"
            ),
            optional_inner_with_a_name_of_some_length=a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_inner.to_ros(
                payload.optional_inner_with_a_name_of_some_length
            ),
            an_enum=payload.an_enum,
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_strings=list(
                payload.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_strings
            ),
        )

    @staticmethod
    def from_ros(
        message: AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine,
    ) -> (
        a_file_with_a_long_name_pb2.AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine
    ):
        """Convert rover/msg/AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine to AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine."""
        return a_file_with_a_long_name_pb2.AMessageNameThatIsSoLongThatTwoOfThemNeverFitIntoOneLine(
            nested_in_a_field_with_a_long_name={
                "taken_apart": {
                    "value_with_a_name_of_some_length": message.value_with_a_name_of_some_length,
                    "values": message.values_of_a_list_with_a_name_of_some_length,
                    "maybe_with_a_name": (
                        message.maybe_with_a_name_that_is_very_long_indeed
                        if message.has_maybe_with_a_name_that_is_very_long_indeed
                        else None
                    ),
                    "inner": a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_inner.from_ros(
                        message.inner_with_a_name_that_is_very_long_indeed
                    ),
                    "inners": [
                        a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_inner.from_ros(
                            item
                        )
                        for item in message.inners_with_a_name_that_is_very_long_indeed
                    ],
                }
            },
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line=(
                message.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line
                if message.has_a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line
                else None
            ),
            an_optional_mode_with_a_name_that_is_long=(
                message.an_optional_mode_with_a_name_that_is_long.value_of_the_mode
                if message.has_an_optional_mode_with_a_name_that_is_long
                else None
            ),
            repeated_modes_with_a_name_that_is_long=[
                item.value_of_the_mode
                for item in message.repeated_modes_with_a_name_that_is_long
            ],
            inner_with_a_name_of_some_length=a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_inner.from_ros(
                message.inner_with_a_name_of_some_length
            ),
            inners_with_a_name_of_some_length=[
                a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_inner.from_ros(
                    item
                )
                for item in message.inners_with_a_name_of_some_length
            ],
            optional_inner_with_a_name_of_some_length=(
                a_message_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_inner.from_ros(
                    message.optional_inner_with_a_name_of_some_length
                )
                if message.has_optional_inner_with_a_name_of_some_length
                else None
            ),
            an_enum=message.an_enum,
            a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_strings=message.a_name_that_is_so_long_that_two_of_them_never_fit_into_one_line_of_strings,
        )
