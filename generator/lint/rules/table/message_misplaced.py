"""The name or the folder of a message does not show to which part of the rover the message belongs.

The key `prefixes` of a peer lists its parts, such as `SensorBoard` for the sensor board. Names of the board's messages
must start with this prefix, as in SensorBoardGPSInfo, and their files must be in a folder `sensor_board/`. If a message
has another name or is in another folder, the developers of the board do not find it when they change their firmware.
Messages of peers without `prefixes` may have any name.

Bad::

    // components/arm_board/gps_sensor.proto
    message SensorBoardGPSInfo {}
    // components/sensor_board/wind.proto
    message Wind {}

Good::

    // components/sensor_board/gps_sensor.proto
    message SensorBoardGPSInfo {}
    // components/sensor_board/wind.proto
    message SensorBoardWind {}
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity, Span
from roverlink.generator.ir.ros_names import snake_case
from roverlink.generator.lint.context import Context
from roverlink.generator.table import Row

RULE = Rule("NAM102", "message-misplaced", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each payload whose name or folder does not match the prefixes of its peer."""
    table = context.table
    if not table.whole:
        return  # the prefix may be in a part that could not be read
    with_prefixes = {peer.name for peer in table.peers if peer.prefixes}
    prefixes = {prefix for peer in table.peers for prefix in peer.prefixes}
    travelling = {row.proto: row for row in reversed(table.rows) if row.peer in with_prefixes}
    for row in travelling.values():
        name = row.proto.rpartition(".")[2]
        own = sorted(prefix for prefix in prefixes if name.startswith(prefix) or row.proto.startswith(prefix))
        yield from _check_folder(row, own, context) if own else _not_prefixed(row, sorted(prefixes), context)


def _not_prefixed(row: Row, prefixes: list[str], context: Context) -> Iterator[Diagnostic]:
    message = f"the name of the message {row.proto!r} does not start with any of the `prefixes` of the peers"
    help = f"start the name with {' or '.join(prefixes)}, or add its prefix to the `prefixes` of a peer"
    span, also = _place(row, context)
    yield RULE.at(span, message, help, also, type=row.proto)


def _check_folder(row: Row, prefixes: list[str], context: Context) -> Iterator[Diagnostic]:
    declared = context.schema.messages.get(row.proto) if context.schema else None
    folders = [snake_case(prefix) for prefix in prefixes]
    if declared is not None and PurePosixPath(declared.file).parent.name not in folders:
        message = (
            f"{row.proto!r} is declared in {declared.file}, but its prefix requires a folder "
            f"{' or '.join(map(repr, folders))}"
        )
        span, also = _place(row, context)
        help = "move the message to a file in that folder, or start its name with the prefix of its present folder"
        yield RULE.at(span, message, help, also, type=row.proto)


def _place(row: Row, context: Context) -> tuple[Span, list[tuple[Span, str]]]:
    """Return the place for a row's diagnostic, and its related places.

    This is the declaration of the message, with the row as related place. If the declaration is unknown, it is the row.
    """
    declared = context.schema.messages.get(row.proto) if context.schema else None
    if declared is None:
        return row.at("proto"), []
    return declared.at("name"), [(row.at("proto"), "a row uses the message here")]
