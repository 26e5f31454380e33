"""Target `nanopb`: .options files for nanopb, the protobuf library for microcontrollers.

They contain the table's size limits of fields, so that the firmware has buffers of these sizes. If the envelope has a
signature, the functions in C that sign and verify datagrams are there, too.

`nanopb_generator --options-path generated/nanopb -I proto FILE.proto` reads the .options files.
"""

from __future__ import annotations

import itertools

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, shipped
from roverlink.generator.nanopb import as_options, options_file_of


def emit(bridge: ir.Bridge) -> Files:
    """Yield a .options file for each .proto file that has fields with size limits, and the functions for signatures."""
    in_order = sorted(bridge.bounds, key=lambda bound: (bound.file, bound.message, bound.field))
    for file, bounds in itertools.groupby(in_order, lambda bound: bound.file):
        lines = [f"{bound.message}.{bound.field} {_options(bound)}" for bound in bounds]
        yield f"generated/nanopb/{options_file_of(file)}", "\n".join([header(bridge.table), "", *lines, ""])
    if bridge.envelope.signature is not None:
        for path in sorted(shipped("cpp").glob("c/*")):
            mark = header(f"roverlink's cpp/c/{path.name}", "//")
            yield f"generated/nanopb/{path.name}", f"{mark}\n\n{path.read_text(encoding='utf-8')}"


def _options(bound: ir.FieldBound) -> str:
    return " ".join(f"{name}:{value}" for name, value in as_options(bound).items())
