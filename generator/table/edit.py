"""Changes of the text of mapping.yaml that keep comments and layout: adding a row, and retiring a payload."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import yaml
from yaml.nodes import CollectionNode, MappingNode, Node, ScalarNode, SequenceNode

from roverlink.generator.diagnostics import DiagnosticsError, Span
from roverlink.generator.source_files import visible
from roverlink.generator.table.edit_rules import NoPlaceForARow, NoSuchRow

# `yaml.load` and `yaml.dump` would lose every comment, the order of keys and the style of each row; a library that
# keeps them would be one more dependency. So the YAML parser only tells where nodes start and end, and the edits are
# changes of lines. A style that is not known is refused, and never guessed.

Edit = tuple[int, int, list[str]]
"""Change of a text: the lines from the first number up to, but not including, the second become the new lines.

The line numbers count from 0.
"""

# The indicators of YAML 1.1 (section 5.3). Not all of them are special at every place, but quotes do no harm.
_MARKS = frozenset("{}[],:#&*!|>'\"%@`")
_KEPT = ("number", "name", "proto")
"""Keys of a row that are kept when it moves to `retired`."""


def with_row(text: str, row: Mapping[str, str | int], file: str) -> str:
    """Return the table's text with a row added after the last row, in the style of that row.

    ``row`` has the value of each key of the new row, and ``file`` is the table's name in diagnostics. Raises
    `DiagnosticsError` if the table has no rows, or if they are not a block list (lines that start with ``-``).
    """
    messages = _value_of(yaml.compose(text, Loader=yaml.SafeLoader), "messages")
    last = messages.value[-1] if isinstance(messages, SequenceNode) and messages.value else None
    if not isinstance(messages, SequenceNode) or messages.flow_style or not isinstance(last, MappingNode):
        message = "`messages` has no list of rows with one row per line"
        raise DiagnosticsError(
            [
                NoPlaceForARow.at(
                    Span(file), message, "write the rows by hand, each one on its own line that starts with `- `"
                )
            ]
        )
    lines = text.splitlines(keepends=True)
    entries = [f"{key}: {value if isinstance(value, int) else scalar(value)}" for key, value in row.items()]
    end = _last_line(last) + 1
    if lines[end - 1][-1:] != "\n":
        lines[end - 1] += "\n"
    margin = " " * messages.start_mark.column
    return _edited(lines, [_row(end, margin, entries, flow=bool(last.flow_style))])


def with_retired(text: str, retiring: int | str, file: str) -> str:
    """Return the table's text with a row moved from `messages` to `retired`; ``retiring`` is its number or its name.

    ``file`` is the table's name in diagnostics. Raises `DiagnosticsError` if no row has the number or the name.
    """
    root = yaml.compose(text, Loader=yaml.SafeLoader)
    messages, retired = _value_of(root, "messages"), _value_of(root, "retired")
    rows = messages.value if isinstance(messages, SequenceNode) else []
    key, shown = ("number", str(retiring)) if str(retiring).isdecimal() else ("name", repr(retiring))
    row = next((row for row in rows if _scalar_of(row, key) == str(retiring)), None)
    if row is None:
        known = f"known {key}s: {', '.join(_scalar_of(row, key) for row in rows)}" if rows else ""
        raise DiagnosticsError([NoSuchRow.at(Span(file), f"no row under `messages` has the {key} {shown}", known)])
    entry = "{" + ", ".join(f"{key}: {_scalar_of(row, key)}" for key in _KEPT) + "}"
    lines = text.splitlines(keepends=True)
    removal = row.start_mark.line, _last_line(row) + 1, list[str]()
    return _edited(lines, [removal, _retired(lines, retired, entry)])


def scalar(text: str) -> str:
    """Return a string as it must stand in a YAML file: in quotes only if YAML would not read it as the same string.

    >>> scalar("imu_info"), scalar("yes")
    ('imu_info', '"yes"')
    """
    # `yes`, `012`, `1:30` and `2026-01-01` have no indicator, and are not strings in YAML 1.1. The parser itself is the
    # judge.
    plain = text and not set(text) & _MARKS and visible(text) == text and yaml.safe_load(text) == text
    return text if plain else quoted(text)


def quoted(text: str) -> str:
    """Return a string in double quotes for a YAML file; quotes, backslashes and unprintable characters are escaped."""
    escaped = visible(text.replace("\\", "\\\\").replace('"', '\\"')).replace("\n", "\\n")
    return f'"{escaped}"'


def _edited(lines: list[str], edits: Iterable[Edit]) -> str:
    """Return the text that results if the edits are applied to the lines; the edits must not overlap."""
    # From the end to the start, so that the line numbers of the remaining edits stay valid.
    for first, last, replacement in sorted(edits, key=lambda edit: edit[0], reverse=True):
        lines[first:last] = replacement
    return "".join(lines)


def _row(end: int, margin: str, entries: list[str], *, flow: bool) -> Edit:
    if flow:
        return end, end, [f"{margin}- {{{', '.join(entries)}}}\n"]
    first, *others = entries
    return end, end, [f"{margin}- {first}\n", *(f"{margin}  {entry}\n" for entry in others)]


def _retired(lines: list[str], retired: Node | None, entry: str) -> Edit:
    """Return the edit that adds an entry to the list under `retired`, in the style of the list.

    ``retired`` is the YAML node of the list; None if the table has none.
    """
    if retired is None or not isinstance(retired, SequenceNode):
        end = "" if not lines or lines[-1].endswith("\n") else "\n"
        return len(lines), len(lines), [f"{end}retired:\n", f"  - {entry}\n"]
    if not retired.flow_style:
        last = _last_line(retired) + 1
        return last, last, [f"{' ' * retired.start_mark.column}- {entry}\n"]
    first, last = retired.start_mark.line, retired.end_mark.line
    # A list in brackets: the entry goes before the closing bracket, whatever follows on that line.
    if retired.value:
        closing = retired.end_mark.column - 1
        line = lines[last]
        return last, last + 1, [f"{line[:closing].rstrip()}, {entry}{line[closing:]}"]
    before, behind = lines[first][: retired.start_mark.column].rstrip(), lines[last][retired.end_mark.column :]
    return first, last + 1, [f"{before}{behind}", f"  - {entry}\n"]


def _value_of(node: Node | None, key: str) -> Node | None:
    """Return the value of a key in a YAML mapping; None if the key is missing."""
    if isinstance(node, MappingNode):
        for key_node, value in node.value:
            if key_node.value == key:
                return value  # type: ignore[no-any-return]  # yaml does not type its nodes' values
    return None


def _scalar_of(row: Node, key: str) -> str:
    node = _value_of(row, key)
    return str(node.value) if isinstance(node, ScalarNode) else ""


def _last_line(node: Node) -> int:
    """Return the last line of a YAML node that is not blank or a comment, counted from 0.

    YAML ends a block node where the next node starts, after blank lines and comments; a row must not be added there.
    """
    if not isinstance(node, CollectionNode) or node.flow_style or not node.value:
        return int(node.end_mark.line)
    return max(_last_line(part) for part in _parts(node))


def _parts(node: Node) -> Iterator[Node]:
    for part in node.value:
        yield from part if isinstance(part, tuple) else [part]
