"""A payload stands in the envelope beside the oneof.

The receiver looks at which member of the oneof is set; what stands beside it is carried along and reaches nobody. It
was added one line too low, mostly, behind the oneof's brace. A number or a text beside the oneof is no payload; an
envelope of another repository may have those, such as a sequence number.

Bad::

    message PBEnvelope {
      oneof payload {
        SensorBoardGPSInfo gps_info = 12;
      }
      SensorBoardIMUInfo imu_info = 13;
    }

Good::

    message PBEnvelope {
      oneof payload {
        SensorBoardGPSInfo gps_info = 12;
        SensorBoardIMUInfo imu_info = 13;
      }
    }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.protos.schema import ProtoField

RULE = Rule("ENV106", "payload-outside-oneof", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Messages in the envelope that are not in its oneof; any field, where it is to hold nothing but the oneof."""
    settings = context.table.envelope
    envelope = context.schema.messages.get(settings.message) if context.schema else None
    if envelope is None or settings.oneof not in envelope.oneofs:
        return
    ours = settings.owner == "mapping"
    for field in envelope.fields:
        if field.oneof != settings.oneof and (ours or _is_payload(field)):
            message = f"{field.name} = {field.number} ({field.wire_type}) stands outside the oneof {settings.oneof}"
            help = f"move {field.name} into {settings.oneof}"
            if ours:
                help = "the file is written from the table: add a row if it is to travel, and run `roverlink generate`"
            yield RULE.at(field.span, message, help, type=envelope.full_name, number=field.number)


def _is_payload(field: ProtoField) -> bool:
    return field.type == "message" and not field.type_name.startswith("google.protobuf.")
