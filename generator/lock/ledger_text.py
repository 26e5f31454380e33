"""Conversion of the compiled table and the previous ledger to the text of mapping.lock or accepted-numbers.lock."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from roverlink.generator import ir
from roverlink.generator.lock.ledger import Burned, Ledger, PastUse, Settled, checksum
from roverlink.generator.lock.row_settings import RowSettings
from roverlink.generator.protos.schema import ProtoEnumValue, ProtoField

# An excerpt, in which row 7 was deleted without being retired, and the field y of Imu as well:
#
#     numbers:
#       1: imu_info Imu on imu_data
#       6: wind Wind retired
#       7: gps_info Gps gone
#     rows:
#       1 Imu direction: board_to_ros
#     schema:
#       message Imu:
#         1 x float
#         2 y float gone
#     burned:
#       Envelope 7: Gps gps_info | Wind wind now -- no board with the GPS was built
#       Envelope 8: Status status now | Status status #1f0a63d2
#
# Status 8 had other fields under the same name: the digest stands for the fields that replaced the first ones.
# No line depends on another one. So a merge conflict, which the checksum always gives, is read line by line.
_HEADER = """\
# The ledger of {table}: every envelope number ever published, and the rows and wire schema of the last generate.
# Written by `roverlink generate`; never edited. After a merge conflict in here, run it again.
"""
_ACCEPTED_HEADER = """\
# Accepted in this folder: numbers that had several meanings in git's history, and findings of rules (`lint`).
# Written by `roverlink lint --accept`; never edited. After a merge conflict in here, accept one of them again.
"""


def render_accepted(ledger: Ledger) -> str:
    """Return the text of accepted-numbers.lock, the ledger of a folder of .proto files without a table."""
    lines = [_ACCEPTED_HEADER, "version: 1", *(_burned_lines(ledger.burned) if ledger.burned else ())]
    lines += ["", "lint:", *map(_settled_line, ledger.settled)] if ledger.settled else []
    return _with_checksum(lines)


def _settled_line(settled: Settled) -> str:
    reason = f"-- {settled.reason}" if settled.reason else ""
    return f"  rule {' '.join(filter(None, (settled.rule, settled.subject, reason)))}"


def render(bridge: ir.Bridge, settings: RowSettings, published: Ledger, unmarked: Sequence[str] = ()) -> str:
    """Return the new text of mapping.lock for a table without errors.

    ``settings`` are those of the table's rows. ``published`` is the ledger before this run. ``unmarked`` are the paths
    of the generated files without a header, so that the next run knows that it may replace them.
    """
    messages = {message.name: _message_lines(message) for message in bridge.wire_messages}
    enums = {enum.name: _enum_lines(enum) for enum in bridge.wire_enums}
    numbers = _number_lines(bridge, published)
    lines = [_HEADER.format(table=bridge.table), "version: 1", ""]
    lines += ["numbers:", *(f"  {number}: {text}" for (number, _), text in numbers.items())]
    # A retired row keeps its settings, so that it cannot come back with another direction.
    known = {**published.settings, **settings}
    lines += ["", "rows:"]
    for number, proto in numbers:
        of_row = known.get((number, proto), {})
        lines += [f"  {number} {proto} {key}: {setting.text}" for key, setting in sorted(of_row.items())]
    lines += ["", "schema:"]
    for name in sorted({*messages, *published.schema.messages}):
        now = messages.get(name, [])
        gone = _gone(published.fields(name), published.gone_fields.get(name, ()), now)
        lines += [f"  message {name}:", *now, *(f"{line} gone" for line in gone)]
    for name in sorted({*enums, *published.schema.enums}):
        now = enums.get(name, [])
        gone = _gone(published.values(name), published.gone_values.get(name, ()), now)
        lines += [f"  enum {name}:", *now, *(f"{line} gone" for line in gone)]
    if published.burned:
        lines += _burned_lines(published.burned)
    if unmarked:
        lines += ["", "files:", *(f"  file {path}" for path in unmarked)]
    return _with_checksum(lines)


def _with_checksum(lines: Iterable[str]) -> str:
    text = "\n".join(lines) + "\n\n"
    return f"{text}checksum: {checksum(text)}\n"


def _burned_lines(burned: Iterable[Burned]) -> list[str]:
    ordered = sorted(burned, key=lambda number: (number.owner, number.number))
    return ["", "burned:", *map(_burned_line, ordered)]


def _burned_line(burned: Burned) -> str:
    uses = (_use(use) + (" now" if use == burned.now else "") for use in burned.uses)
    reason = f" -- {burned.reason}" if burned.reason else ""
    return f"  {burned.owner} {burned.number}: {' | '.join(uses)}{reason}"


def _use(use: PastUse) -> str:
    return " ".join(filter(None, (use.type, use.name, use.content and f"#{use.content}")))


def _number_lines(bridge: ir.Bridge, published: Ledger) -> dict[tuple[int, str], str]:
    """Return what mapping.lock says about each published payload, by number and message, in the order of the file."""
    topics = {route.number: f" on {route.topic}" for route in bridge.routes}  # the link message has no topic
    lines = {
        (member.number, member.proto): f"{member.name} {member.proto}{topics.get(member.number, '')}"
        for member in bridge.envelope.members
    }
    lines |= {(row.number, row.proto): f"{row.name} {row.proto} retired" for row in bridge.envelope.retired}
    if bridge.envelope.signature is not None:
        lines[bridge.envelope.signature, "bytes"] = "signature bytes"
    taken = {number for number, _ in lines}
    for entry in published.entries:
        # One branch had published the number, and the merged table gives it to another payload: the other branch lost.
        # Its entry must not stay as `gone`, which would report a reuse for ever.
        settled = entry.contested and entry.number in taken
        if not settled:
            lines.setdefault((entry.number, entry.proto), f"{entry.name} {entry.proto} gone")
    return dict(sorted(lines.items()))


def _gone(
    published: Sequence[ProtoField | ProtoEnumValue], gone: Sequence[ProtoField | ProtoEnumValue], now: Sequence[str]
) -> Iterator[str]:
    """Yield the lines of mapping.lock to mark as ``gone``, for the fields of a message or the values of an enum.

    A field gets such a line if its number is unused now, or if it was gone before and has not come back. ``published``
    are all fields or values in the ledger, ``gone`` those that did not exist at the last run, and ``now`` the lines of
    today's fields or values.
    """
    used = {line.split()[0] for line in now}
    for entry in published:
        line = _fact_line(entry.on_the_wire())
        # A fact that was gone before stays gone, although its number may be in use again; unless the same fact came
        # back.
        if str(entry.number) not in used or (entry in gone and line not in now):
            yield line


def _fact_line(fact: ir.WireField | ir.WireValue) -> str:
    if isinstance(fact, ir.WireValue):
        return f"    {fact.number} {fact.name}"
    label = f"{fact.label} " if fact.label else ""
    oneof = f" in {fact.oneof}" if fact.oneof else ""
    return f"    {fact.number} {fact.name} {label}{fact.type}{oneof}"


def _reserved_lines(of: ir.WireMessage | ir.WireEnum) -> Iterator[str]:
    for first, last in of.reserved:
        yield f"    reserved {first}" if first == last else f"    reserved {first} to {last}"
    yield from (f'    reserved "{name}"' for name in of.reserved_names)


def _message_lines(message: ir.WireMessage) -> list[str]:
    return [*map(_fact_line, message.fields), *_reserved_lines(message)]


def _enum_lines(enum: ir.WireEnum) -> list[str]:
    return [*map(_fact_line, enum.values), *_reserved_lines(enum)]


def schema_lines(messages: Iterable[ir.WireMessage], enums: Iterable[ir.WireEnum]) -> list[str]:
    """Return the lines of mapping.lock that describe messages and enums: ``    1 x float`` for a field."""
    lines = [line for message in messages for line in (f"message {message.name}", *_message_lines(message))]
    return lines + [line for enum in enums for line in (f"enum {enum.name}", *_enum_lines(enum))]
