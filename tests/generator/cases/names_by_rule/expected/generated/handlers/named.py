# Generated from mapping.yaml (row named) and named.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row named: odd_names and rover/msg/OddNames."""

from __future__ import annotations

from generated.conversions import in_side
from generated.messages import OddNames, OddNamesTryEntry
from generated.pb2 import named_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.convert.keywords import keywords
from roverlink.runtime.convert.maps import mapping
from roverlink.runtime.core.handler import Handler, Route

WHICH_WITH_MEMBERS = {
    "global": OddNames.WITH_GLOBAL,
    "pass": OddNames.WITH_PASS,
}


class NamedHandler(Handler[named_pb2.odd_names, OddNames]):
    """odd_names as rover/msg/OddNames.

    Number 1 of the envelope, board_to_ros, topic named.
    """

    route = Route(
        number=1,
        name="named",
        topic="named",
        direction="board_to_ros",
    )
    payload_type = named_pb2.odd_names
    message_type = OddNames

    @staticmethod
    def to_ros(payload: named_pb2.odd_names) -> OddNames:
        """Convert odd_names to rover/msg/OddNames."""
        return OddNames(
            class_field=getattr(payload, "class"),
            from_field=getattr(payload, "from"),
            camel_case=payload.camelCase,
            http_server=payload.HTTPServer,
            two_underscores=payload.two__underscores,
            trailing=payload.trailing_,
            leading=payload._leading,
            list_field=list(payload.list),
            operator_field=payload.operator,
            field_1st=payload._1st,
            capitals=payload.CAPITALS,
            has_is_field=payload.HasField("is"),
            is_field=getattr(payload, "is"),
            import_field=[in_side.to_ros(item) for item in getattr(payload, "import")],
            which_with=oneof.number(payload, "with", WHICH_WITH_MEMBERS),
            global_field=getattr(payload, "global"),
            pass_field=getattr(payload, "pass"),
            try_field=[
                OddNamesTryEntry(key=key, value=value)
                for key, value in sorted(getattr(payload, "try").items())
            ],
            mode=payload.mode,
        )

    @staticmethod
    def from_ros(message: OddNames) -> named_pb2.odd_names:
        """Convert rover/msg/OddNames to odd_names."""
        which_with = oneof.member(message.which_with, WHICH_WITH_MEMBERS, "which_with")
        return named_pb2.odd_names(
            camelCase=message.camel_case,
            HTTPServer=message.http_server,
            two__underscores=message.two_underscores,
            trailing_=message.trailing,
            _leading=message.leading,
            list=message.list_field,
            operator=message.operator_field,
            _1st=message.field_1st,
            CAPITALS=message.capitals,
            mode=message.mode,
            **keywords(
                {
                    "class": message.class_field,
                    "from": message.from_field,
                    "is": message.is_field if message.has_is_field else None,
                    "import": [in_side.from_ros(item) for item in message.import_field],
                    "global": message.global_field if which_with == "global" else None,
                    "pass": message.pass_field if which_with == "pass" else None,
                    "try": mapping(
                        ((item.key, item.value) for item in message.try_field),
                        "try_field",
                    ),
                }
            ),
        )
