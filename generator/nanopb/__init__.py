"""What nanopb makes of messages on microcontrollers: its options, and the largest encoding that they leave room for.

nanopb (https://jpa.kapsi.fi/nanopb) compiles .proto files to C with fixed buffers. How large those are is said beside
the .proto files: in a ``.options`` file, or in options numbered 1010 inside. The numbers here are those that nanopb's
generator (0.4.9.1) writes as ``<Message>_size``, the size of the buffer that such a board sends from; the tests hold
them against it. They are upper bounds for what nanopb encodes, not the tightest ones, and count no extensions.
The names and values of the options come from the installed nanopb package; bounds in the table do without it.

- `table_bounds` are those that the table gives, and `as_lines` makes options of them;
- `read_bounds` reads the options of a schema, each with the place where it was said, if nanopb is installed;
- `largest_size` says how many bytes a message takes at most, or which field has no bound.
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
