"""Retiring a payload: its row moves to ``retired``, in the text of mapping.yaml, whose comments and layout stay."""

from __future__ import annotations

import yaml
from yaml.nodes import Node, ScalarNode, SequenceNode

from generator.diagnostics import DiagnosticsError, Span
from generator.edit_rules import NO_SUCH_ROW
from generator.yaml_text import Edit, edited, last_line, value_of

_KEPT = ("number", "name", "proto")


def with_retired(text: str, number: int, file: str) -> str:
    """The table's text with the row of a number retired.

    ``file`` is how findings call the table. Raises `DiagnosticsError` where no row has the number.
    """
    root = yaml.compose(text, Loader=yaml.SafeLoader)
    messages, retired = value_of(root, "messages"), value_of(root, "retired")
    rows = messages.value if isinstance(messages, SequenceNode) else []
    row = next((row for row in rows if _scalar(row, "number") == str(number)), None)
    if row is None:
        raise DiagnosticsError(
            [NO_SUCH_ROW.at(Span(file), f"no row under `messages` has the number {number}", _known(rows))]
        )
    entry = "{" + ", ".join(f"{key}: {_scalar(row, key)}" for key in _KEPT) + "}"
    lines = text.splitlines(keepends=True)
    return edited(lines, [_removal(row), _addition(lines, retired, entry)])


def _scalar(row: Node, key: str) -> str:
    node = value_of(row, key)
    return str(node.value) if isinstance(node, ScalarNode) else ""


def _known(rows: list[Node]) -> str:
    return f"there are {', '.join(_scalar(row, 'number') for row in rows)}" if rows else ""


def _removal(row: Node) -> Edit:
    return row.start_mark.line, last_line(row) + 1, []


def _addition(lines: list[str], retired: Node | None, entry: str) -> Edit:
    """The entry behind what is retired already, in the style in which that is written."""
    if retired is None or not isinstance(retired, SequenceNode):
        end = "" if not lines or lines[-1].endswith("\n") else "\n"
        return len(lines), len(lines), [f"{end}retired:\n", f"  - {entry}\n"]
    if not retired.flow_style:
        last = last_line(retired) + 1
        return last, last, [f"{' ' * retired.start_mark.column}- {entry}\n"]
    first, last = retired.start_mark.line, retired.end_mark.line
    if retired.value:
        closing = retired.end_mark.column - 1
        line = lines[last]
        return last, last + 1, [f"{line[:closing].rstrip()}, {entry}{line[closing:]}"]
    before, behind = lines[first][: retired.start_mark.column].rstrip(), lines[last][retired.end_mark.column :]
    return first, last + 1, [f"{before}{behind}", f"  - {entry}\n"]
