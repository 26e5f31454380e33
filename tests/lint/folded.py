"""Files of golden cases as they stand in YAML: .proto files in one line each, unfolded to what a person would write.

`message Arm { float voltage = 1; }` becomes a file of proto3, with each declaration in a line of its own: the first
field is in line 4. A text that begins with `syntax` or `edition` keeps it. A text of several lines stays as it is.
"""

from __future__ import annotations

import re

_PIECE = re.compile(r"[^{};]*[{};]")


def unfold(text: str) -> str:
    """Return the file of a text: a .proto file in one line, or any other file as it is."""
    if "\n" in text:
        return text
    if not text.startswith(("syntax", "edition")):
        text = f'syntax = "proto3"; {text}'
    lines: list[str] = []
    depth = 0
    for piece in map(str.strip, _PIECE.findall(text)):
        depth -= piece == "}"
        if (
            depth == 0
            and lines
            and piece != "}"
            and not (piece.startswith("import") and lines[-1].startswith("import"))
        ):
            lines.append("")
        lines.append("  " * depth + piece)
        depth += piece.endswith("{")
    return "\n".join(lines) + "\n"
