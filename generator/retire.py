"""Retiring a payload: its row moves to ``retired``, in the text of mapping.yaml, whose comments and layout stay."""

from __future__ import annotations

from collections.abc import Iterator

import yaml
from yaml.nodes import CollectionNode, MappingNode, Node, ScalarNode, SequenceNode

from generator.findings import FindingsError, Rule, Span

NO_SUCH_ROW = Rule("RET101", "no-such-row")

_KEPT = ("number", "name", "proto")


def with_retired(text: str, number: int, file: str) -> str:
    """The table's text with the row of a number retired.

    ``file`` is how findings call the table. Raises `FindingsError` where no row has the number.
    """
    root = yaml.compose(text, Loader=yaml.SafeLoader)
    messages, retired = _value(root, "messages"), _value(root, "retired")
    rows = messages.value if isinstance(messages, SequenceNode) else []
    row = next((row for row in rows if _scalar(row, "number") == str(number)), None)
    if row is None:
        raise FindingsError(
            [NO_SUCH_ROW.at(Span(file), f"no row under `messages` has the number {number}", _known(rows))]
        )
    entry = "{" + ", ".join(f"{key}: {_scalar(row, key)}" for key in _KEPT) + "}"
    lines = text.splitlines(keepends=True)
    # From the end to the start, so that the places of what is still to be changed stay true.
    edits = sorted([_removal(row), _addition(lines, retired, entry)], key=lambda edit: edit[0], reverse=True)
    for first, last, replacement in edits:
        lines[first:last] = replacement
    return "".join(lines)


_Edit = tuple[int, int, list[str]]
"""Lines from the first to before the last, counted from 0, become other lines."""


def _value(node: Node | None, key: str) -> Node | None:
    if isinstance(node, MappingNode):
        for key_node, value in node.value:
            if key_node.value == key:
                return value  # type: ignore[no-any-return]  # yaml does not type its nodes' values
    return None


def _scalar(row: Node, key: str) -> str:
    node = _value(row, key)
    return str(node.value) if isinstance(node, ScalarNode) else ""


def _known(rows: list[Node]) -> str:
    return f"there are {', '.join(_scalar(row, 'number') for row in rows)}" if rows else ""


def _removal(row: Node) -> _Edit:
    return row.start_mark.line, _last_line(row) + 1, []


def _last_line(node: Node) -> int:
    """The last line with something of a node; a block's own end is where the next thing starts."""
    if not isinstance(node, CollectionNode) or node.flow_style or not node.value:
        return int(node.end_mark.line)
    return max(_last_line(part) for part in _parts(node))


def _parts(node: Node) -> Iterator[Node]:
    for part in node.value:
        yield from part if isinstance(part, tuple) else [part]


def _addition(lines: list[str], retired: Node | None, entry: str) -> _Edit:
    """The entry behind what is retired already, in the style in which that is written."""
    if retired is None or not isinstance(retired, SequenceNode):
        end = "" if not lines or lines[-1].endswith("\n") else "\n"
        return len(lines), len(lines), [f"{end}retired:\n", f"  - {entry}\n"]
    if not retired.flow_style:
        last = _last_line(retired) + 1
        return last, last, [f"{' ' * retired.start_mark.column}- {entry}\n"]
    first, last = retired.start_mark.line, retired.end_mark.line
    if retired.value:
        closing = retired.end_mark.column - 1
        line = lines[last]
        return last, last + 1, [f"{line[:closing].rstrip()}, {entry}{line[closing:]}"]
    before, behind = lines[first][: retired.start_mark.column].rstrip(), lines[last][retired.end_mark.column :]
    return first, last + 1, [f"{before}{behind}", f"  - {entry}\n"]
