"""What a .proto file declares, as far as it can be read: no line, however broken, hides the others.

protoc reads files that compile, and of those this package says the same: names, numbers, types and places.
It is there for the other files: old states of a repository, half-edited ones, those with conflict markers. It knows no
file but the one it is given, so a type is what is written; `resolve_type` finds its full name among those declared.

What it rests on:

- a file is cut into tokens, tokens into statements, and each statement is read by itself;
- what cannot be read is a `Problem` of the file, and reading goes on behind it;
- braces that match are believed, however the file is indented; where some do not, its lines and indentation say more;
- nothing is looked at more than a few times, and nothing recurs deeper than protoc lets messages nest.
"""

from __future__ import annotations

from roverlink.generator.protos.parser.parsed_file import (
    LARGEST_ENUM_NUMBER,
    LARGEST_FIELD_NUMBER,
    File,
    Import,
    Problem,
)
from roverlink.generator.protos.parser.parser import parse
from roverlink.generator.protos.parser.type_names import SCALARS, resolve_type

__all__ = [
    "LARGEST_ENUM_NUMBER",
    "LARGEST_FIELD_NUMBER",
    "SCALARS",
    "File",
    "Import",
    "Problem",
    "parse",
    "resolve_type",
]
