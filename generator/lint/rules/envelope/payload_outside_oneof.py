"""A payload stands in the envelope outside of the oneof.

The receiver looks at the member of the oneof that is set, and ignores everything beside it. Usually the payload was
added one line too low, behind the oneof's closing brace. A number or a string beside the oneof is not a payload:
envelopes of another repository may have them, such as a sequence number.

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
    """Yield a diagnostic for each message of the envelope that is outside of the oneof.

    If the table owns the envelope, each field of another type outside of the oneof is reported, too.
    """
    settings = context.table.envelope
    envelope = context.schema.messages.get(settings.message) if context.schema else None
    if envelope is None or settings.oneof not in envelope.oneofs:
        return
    ours = settings.owner == "mapping"
    signing = context.table.signing
    for field in envelope.fields:
        if signing and (field.number, field.name) == (signing.number, signing.name):
            continue
        if field.oneof != settings.oneof and (ours or _is_payload(field)):
            message = f"`{field.name} = {field.number}` ({field.wire_type}) is outside of the oneof {settings.oneof!r}"
            help = f"move {field.name!r} into the oneof {settings.oneof!r}"
            if ours:
                help = "add a row for the payload, and run `roverlink generate`, which writes this file from the table"
            yield RULE.at(field.span, message, help, type=envelope.full_name, number=field.number)


def _is_payload(field: ProtoField) -> bool:
    return field.type == "message" and not field.type_name.startswith("google.protobuf.")
