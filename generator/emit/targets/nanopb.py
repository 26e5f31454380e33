"""Target `nanopb`: files for nanopb, the protobuf library for microcontrollers.

The .options files contain the table's size limits of fields, so that the firmware has buffers of these sizes.
`nanopb_generator --options-path generated/nanopb -I proto FILE.proto` reads them. If the table has the link message,
`roverlink_link.h` has the hash of each row's schema, and functions that fill and take link messages. If the envelope
has a signature, the functions in C that sign and verify datagrams are there, too, and if an end is on a serial line,
those that write and read its frames.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, render, shipped
from roverlink.generator.nanopb import as_options, options_file_of
from roverlink.transport_addresses import on_serial_line


def emit(bridge: ir.Bridge) -> Files:
    """Yield a .options file for each .proto file with size limits, the link message's header, and the C of the link."""
    in_order = sorted(
        (*bridge.bounds, *_bounds_of_link(bridge)), key=lambda bound: (bound.file, bound.message, bound.field)
    )
    for file, bounds in itertools.groupby(in_order, lambda bound: bound.file):
        lines = [f"{bound.message}.{bound.field} {_options(bound)}" for bound in bounds]
        yield f"generated/nanopb/{options_file_of(file)}", "\n".join([header(bridge.table), "", *lines, ""])
    if bridge.link is not None:
        yield (
            "generated/nanopb/roverlink_link.h",
            render(
                "nanopb/roverlink_link.h.j2",
                header=header(bridge.table, "//"),
                include=f"{bridge.link.file.removesuffix('.proto')}.pb.h",
                ends=list(_ends(bridge)),
            ),
        )
    parts = {
        "framing": on_serial_line(end.host for peer in bridge.peers for end in peer.ends),
        "signing": bridge.envelope.signature is not None,
    }
    for part in (part for part, is_used in parts.items() if is_used):
        for path in sorted(shipped("cpp").glob(f"c/roverlink_{part}.*")):
            mark = header(f"roverlink's cpp/c/{path.name}", "//")
            yield f"generated/nanopb/{path.name}", f"{mark}\n\n{path.read_text(encoding='utf-8')}"


def _options(bound: ir.FieldBound) -> str:
    return " ".join(f"{name}:{value}" for name, value in as_options(bound).items())


def _bounds_of_link(bridge: ir.Bridge) -> Iterator[ir.FieldBound]:
    """Yield the size limits of the link message, which the protocol sets and not the table."""
    if bridge.link is not None:
        for field in ir.LINK_FIELDS:
            if field.label:
                yield ir.FieldBound(bridge.link.file, ir.LINK_MESSAGE, field.name, False, None, ir.LINK_ROWS)


class RowsOfEnd(NamedTuple):
    """Rows of a peer or of a board."""

    name: str
    identifier: str
    """Name as a part of a C identifier."""
    routes: Sequence[ir.Route]
    """Rows of the end, its own ones first: the bridge tells the sender of a link message by them."""


def _ends(bridge: ir.Bridge) -> Iterator[RowsOfEnd]:
    for peer in bridge.peers:
        own = [route for route in bridge.routes if route.peer == peer.name]
        forwarded = [route for route in bridge.routes if peer.name in route.forward]
        if own or forwarded:
            yield RowsOfEnd(f"the peer {peer.name}", peer.name, [*own, *forwarded])
        for board in sorted({route.board for route in own} - {""}):
            name, identifier = f"the board {board} of {peer.name}", re.sub(r"\W", "_", f"{peer.name}_{board}")
            yield RowsOfEnd(name, identifier, [route for route in own if route.board == board])
