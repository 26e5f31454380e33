"""Reader of mapping.yaml. It returns a `Table`, and reports every mistake in the file at its place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from posixpath import normpath
from string import ascii_lowercase

from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span
from roverlink.generator.ir import ros_names
from roverlink.generator.table.keys import LEARN, PeerSettings, Row, StandardTopicSettings, Table
from roverlink.generator.table.parts import Form, build, object_of
from roverlink.generator.table.reading_rules import BadValue, ConflictingKeys, WrongType
from roverlink.generator.table.yaml_items import read_form, read_text

_FIRST_PORT = 6000


def read(path: Path, findings: list[Diagnostic], name: str | None = None) -> Table:
    """Read the table from a file; ``name`` is the file's name in diagnostics.

    A diagnostic for every mistake in the file is added to ``findings``. Correct parts are still read; `Table.whole` is
    False if a part was left out. Raises `DiagnosticsError` if the file is not a table at all.
    """
    file = name or str(path)
    return parse(read_text(path, file), file, findings)


def parse(text: str, file: str, findings: list[Diagnostic]) -> Table:
    """Read the table from a text; ``file`` is its name in diagnostics. Mistakes are handled as in `read`."""
    before = len(findings)
    form = read_form(text, file, object_of(Table), "the table", findings)
    if form is None:
        raise DiagnosticsError(findings)
    # The numbers of rows with mistakes count as used: a next number must not be theirs.
    table = build(Table, form, file=file, whole=len(findings) == before, numbers=frozenset(_numbers(form)))
    rows = tuple(map(_completed, table.rows))
    mistakes = [mistake for row in rows for mistake in _mistakes(row)]
    findings += mistakes
    # One spelling for each folder, because paths of files are compared: `./proto/` is `proto`.
    proto = replace(table.proto, root=normpath(table.proto.root) if table.proto.root else "")
    whole = table.whole and not mistakes
    return replace(table, whole=whole, proto=proto, peers=tuple(_with_ports(table.peers)), rows=rows)


def _completed(row: Row) -> Row:
    """Return a row with the default of `ros`, and with the places of the peers under `forward`."""
    places = {f"forward.{forward.peer}": forward.at("peer") for forward in row.forward_settings}
    ros = row.ros or ros_names.camel_case(row.proto.rpartition(".")[2])
    return replace(row, ros=ros, spans={**row.spans, **places})


def _numbers(table: Form) -> Iterator[int]:
    """Yield the numbers of all rows, retired rows, the link message and the signature.

    Rows that lack a required key are included.
    """
    entries = table.entries or {}
    for key in ("messages", "retired", "link", "signing"):
        for row in entries[key].items or (entries[key],) if key in entries else ():
            if row.entries and "number" in row.entries and isinstance(number := row.entries["number"].value, int):
                yield number


def _with_ports(peers: tuple[PeerSettings, ...]) -> Iterator[PeerSettings]:
    """Yield the peers sorted by name, with default values for a missing port or port parameter.

    The defaults are 6000, 6001... and ``dst_a_port``, ``dst_b_port``... in this order. A peer with a host has the port
    parameter ``<peer>_port``. The port of a host that is learned has no default, because it is learned too.
    """
    for index, peer in enumerate(sorted(peers, key=lambda peer: peer.name)):
        letter = ascii_lowercase[index % len(ascii_lowercase)]
        parameter = peer.parameter or (f"{peer.name}_port" if peer.host else f"dst_{letter}_port")
        default = _FIRST_PORT + index
        boards = (
            replace(board, port=board.port or peer.port or (0 if board.hosts == (LEARN,) else default))
            for board in sorted(peer.boards, key=lambda board: board.name)
        )
        port = peer.port or (0 if peer.hosts == (LEARN,) else default)
        yield replace(peer, parameter=parameter, port=port, boards=tuple(boards))


def _mistakes(row: Row) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each key of a row that contradicts another key of the row."""
    for standard in (row, *row.also):
        yield from _conflicting_depths(standard)
    first: dict[str, Span] = {}
    for forward in row.forward_settings:
        span = forward.at("peer")
        if (before := first.setdefault(forward.peer, span)) is not span and forward.peer:
            message, also = f"`forward` contains {forward.peer!r} twice", [(before, "first here")]
            yield BadValue.at(span, message, "keep one of the two", also)
    if row.standard is None:
        yield from _forms_of_standard_messages(row)


def _conflicting_depths(standard: StandardTopicSettings) -> Iterator[Diagnostic]:
    depth = standard.qos.depth
    if standard.queue is not None and depth is not None and standard.queue != depth:
        message = f"`queue` is {standard.queue}, but `depth` of `qos` is {depth}"
        yield ConflictingKeys.at(
            standard.qos.at("depth"), message, "both keys set the depth of the same queue; keep one of them"
        )


def _forms_of_standard_messages(row: Row) -> Iterator[Diagnostic]:
    """Report values under `fields` that are not strings, in a row whose topic has no standard message.

    Mappings and numbers are sources of a standard message's fields. Other rows only rename fields there.
    """
    for path, form in row.fields.items():
        if path not in row.renames:
            message = (
                f"`fields.{path}` is not a string; without a standard message it must be the name of the ROS field"
            )
            help = "to publish a standard message, write its package in `ros`, as in sensor_msgs/Imu"
            yield WrongType.at(form.span, message, help)
