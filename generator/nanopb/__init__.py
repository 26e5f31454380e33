"""Support for nanopb on microcontrollers: reads its options, and computes the largest encoded size of each message.

nanopb (https://jpa.kapsi.fi/nanopb) compiles .proto files to C structures with fixed buffers. The sizes of these
buffers stand in a ``.options`` file beside the .proto file, or inside it in options with the number 1010. The sizes
computed here equal ``<Message>_size`` of nanopb's generator (0.4.9.1), the size of the buffer that a board sends from;
a test compares them. They are upper bounds, not the tightest ones, and do not count extensions.

The names and values of nanopb's options are read from the installed nanopb package. Size limits in the table do not
need this package.

- `table_bounds` returns the size limits under `bounds` in mapping.yaml, and `as_lines` converts them to options.
- `read_bounds` reads the options of a schema with their places. It needs an installed nanopb.
- `largest_size` returns the largest encoded size of a message, or the field without a size limit.
"""

from __future__ import annotations

from roverlink.generator.nanopb.bounds import Bounds, FieldBounds, MessageBounds
from roverlink.generator.nanopb.message_sizes import Unbounded, envelope_size, field_sizes, largest_size, row_sizes
from roverlink.generator.nanopb.options_file import options_file_of
from roverlink.generator.nanopb.options_in_force import read_bounds
from roverlink.generator.nanopb.table_bounds import as_lines, as_options, table_bounds

__all__ = [
    "Bounds",
    "FieldBounds",
    "MessageBounds",
    "Unbounded",
    "as_lines",
    "as_options",
    "envelope_size",
    "field_sizes",
    "largest_size",
    "options_file_of",
    "read_bounds",
    "row_sizes",
    "table_bounds",
]
