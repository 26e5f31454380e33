"""A tolerant parser of .proto files: a broken line never hides the declarations around it.

For files that compile, this parser and protoc return the same names, numbers, types and places. The parser exists for
the other files: old versions in git, half-edited files, files with conflict markers. It reads one file at a time, so
the type of a field stays as the file writes it. `resolve_type` finds the full name of that type.

Rules:

- The text is cut into tokens, the tokens into statements. Each statement is read by itself.
- A statement that cannot be read becomes a `Problem` of the file, and reading continues after it.
- Matching braces decide where a block ends. If some braces have no partner, lines and indentation help to decide.
- Time is linear in the length of the text, and blocks nest at most as deep as protoc allows.
"""

from __future__ import annotations

from roverlink.generator.protos.parser.parsed_file import (
    LARGEST_ENUM_NUMBER,
    File,
    Import,
    Problem,
)
from roverlink.generator.protos.parser.parser import parse
from roverlink.generator.protos.parser.type_names import SCALARS, map_types, resolve_type

__all__ = [
    "LARGEST_ENUM_NUMBER",
    "SCALARS",
    "File",
    "Import",
    "Problem",
    "map_types",
    "parse",
    "resolve_type",
]
