"""A row names an unknown peer or direction, or forwards datagrams to a wrong peer.

`direction` is `<peer>_to_ros` or `ros_to_<peer>`. `direction` and `forward` must name a peer under `peers`, because the
bridge has no address for others. A row that forwards to its own peer would send every datagram back to its sender.

Bad::

    peers:
      hardware: {}
    messages:
      - {number: 16, name: mode, proto: ControlMode, topic: mode, direction: basestation_to_ros}

Good::

    peers:
      hardware: {}
      basestation: {}
    messages:
      - {number: 16, name: mode, proto: ControlMode, topic: mode, direction: basestation_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Span, nearest
from roverlink.generator.lint.context import Context
from roverlink.generator.table import Row

RULE = Rule("TAB103", "unknown-peer", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row whose `direction` or `forward` is wrong."""
    table = context.table
    peers = sorted(peer.name for peer in table.peers)
    for row in table.rows:
        for key, message, help, also in _faults(row, peers, table.whole):
            yield RULE.at(row.at(key), message, help, also, type=table.envelope.message, number=row.number)


_Fault = tuple[str, str, str, list[tuple[Span, str]]]  # the row's key, the message, the help, related places


def _faults(row: Row, peers: list[str], whole: bool) -> Iterator[_Fault]:
    """Yield what is wrong with a row's `direction` and `forward`.

    ``whole`` is false if parts of the table could not be read. Then unknown peers are not reported.
    """
    malformed = row.direction not in _directions(row.peer)
    if row.direction and (malformed or (whole and row.peer not in peers)):
        yield _unknown_direction(row, peers, malformed)
    if whole:
        yield from _unknown_targets(row, peers)
        if not malformed:
            yield from _misdirected(row)


def _directions(peer: str) -> tuple[str, str]:
    return f"{peer}_to_ros", f"ros_to_{peer}"


def _unknown_direction(row: Row, peers: list[str], malformed: bool) -> _Fault:
    known = [direction for peer in peers for direction in _directions(peer)]
    message = f"unknown direction {row.direction!r} (known: {', '.join(known) or 'none'})"
    if malformed:
        return "direction", message, nearest(row.direction, known, "write `<peer>_to_ros` or `ros_to_<peer>`"), []
    other = f"{'write a known direction, or ' if peers else ''}add the peer {row.peer!r} under `peers`"
    return "direction", message, nearest(row.peer, peers, other), []


def _unknown_targets(row: Row, peers: list[str]) -> Iterator[_Fault]:
    for target in row.forward:
        if target not in peers:
            message = f"unknown peer {target!r} (known: {', '.join(peers) or 'none'})"
            yield f"forward.{target}", message, nearest(target, peers, f"add the peer {target!r} under `peers`"), []


def _misdirected(row: Row) -> Iterator[_Fault]:
    if row.forward and not row.inbound:
        message = f"the direction of {row.name!r} is {row.direction!r}, but `forward` is for datagrams from a peer"
        help = f"write `direction: {row.peer}_to_ros`, or remove `forward`"
        yield "direction", message, help, [(row.at("forward"), "forwarded here")]
    elif row.peer in row.forward:
        message = f"{row.name!r} comes from the peer {row.peer!r}, and `forward` would send it back there"
        yield f"forward.{row.peer}", message, "name another peer under `forward`", []
