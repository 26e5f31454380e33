"""A field number is one that protobuf keeps for itself.

The numbers from 19000 to 19999 belong to protobuf's implementation. protoc rejects them.

Bad::

    - {number: 19000, name: imu_info, proto: SensorBoardIMUInfo, topic: imu_data, direction: hardware_to_ros}

Good::

    - {number: 22, name: imu_info, proto: SensorBoardIMUInfo, topic: imu_data, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.table import IMPLEMENTATION_NUMBERS

RULE = Rule("ENV104", "field-number-out-of-range", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row with a number from 19000 to 19999."""
    envelope = context.table.envelope.message
    message = f"is reserved for protobuf itself ({IMPLEMENTATION_NUMBERS.start} to {IMPLEMENTATION_NUMBERS.stop - 1})"
    for row in context.table.members:
        if row.number in IMPLEMENTATION_NUMBERS:
            yield RULE.at(
                row.at("number"),
                f"field {row.number} {message}",
                f"choose a number below {IMPLEMENTATION_NUMBERS.start}",
                type=envelope,
                number=row.number,
            )
