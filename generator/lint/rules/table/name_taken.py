"""Two payloads of the envelope have the same name.

Members of a oneof need different names, and so do the generated handler classes: names that differ only in capitals or
underscores would become the same class. A retired name is taken forever, like its number. The oneof's own name is taken
too, and with `signing` the name `signature`.

Bad::

    messages:
      - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
      - {number: 22, name: gps, proto: SensorBoardGPSStatus, topic: gps_status, direction: hardware_to_ros}

Good::

    messages:
      - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
      - {number: 22, name: gps_status, proto: SensorBoardGPSStatus, topic: gps_status, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Span
from roverlink.generator.ir.ros_names import distinct
from roverlink.generator.lint.context import Context
from roverlink.generator.table import Numbered, RetiredRow, Row

RULE = Rule("TAB101", "name-taken", __doc__)
_HELP = "choose another name"


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row or signature whose name belongs to an earlier row, a retired row or the oneof.

    Retired rows are compared with each other, too.
    """
    table = context.table
    retired: dict[str, RetiredRow] = {}

    def at(row: Numbered | RetiredRow, message: str, also: tuple[Span, str], help: str = _HELP) -> Diagnostic:
        return RULE.at(row.at("name"), message, help, [also], type=table.envelope.message, number=row.number)

    for gone in table.retired:
        first = retired.setdefault(gone.name, gone)
        if first is not gone:
            message = f"the name {gone.name!r} is retired twice"
            yield at(
                gone,
                message,
                (first.at("name"), "first retired here"),
                "remove one of the two entries, or correct its name",
            )
    seen: dict[str, Numbered] = {}
    # The link message and the signature come first, because nobody can choose another name for them.
    for row in sorted(table.numbered, key=lambda one: isinstance(one, Row)):
        earlier = seen.setdefault(distinct(row.name), row)
        if earlier is not row:
            message = f"the name {row.name!r} is already taken by field {earlier.number} ({earlier.proto})"
            yield at(row, message, (earlier.at("name"), "first used here"))
        elif row.name in retired:
            gone = retired[row.name]
            message = f"the name {row.name!r} belonged to field {gone.number} ({gone.proto}) and is retired"
            yield at(row, message, (gone.at("name"), "retired here"))
        elif row.name == table.envelope.oneof:
            yield at(row, f"{row.name!r} is already the name of the oneof", (table.envelope.at("oneof"), "named here"))
