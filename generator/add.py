"""Adding a row to mapping.yaml, in its text, whose comments and layout stay."""

from __future__ import annotations

from collections.abc import Mapping

import yaml
from yaml.nodes import MappingNode, SequenceNode

from generator.diagnostics import DiagnosticsError, Span
from generator.edit_rules import NO_PLACE_FOR_A_ROW
from generator.yaml_text import Edit, edited, last_line, scalar, value_of


def with_row(text: str, row: Mapping[str, str | int], file: str) -> str:
    """The table's text with a row behind the last one, written as that one is.

    ``file`` is how findings call the table. Raises `DiagnosticsError` where the rows are not a list of one a line.
    """
    messages = value_of(yaml.compose(text, Loader=yaml.SafeLoader), "messages")
    last = messages.value[-1] if isinstance(messages, SequenceNode) and messages.value else None
    if not isinstance(messages, SequenceNode) or messages.flow_style or not isinstance(last, MappingNode):
        message = "there is no list of rows, one below the other, under `messages`"
        raise DiagnosticsError([NO_PLACE_FOR_A_ROW.at(Span(file), message, "write the first row by hand")])
    lines = text.splitlines(keepends=True)
    entries = [f"{key}: {value if isinstance(value, int) else scalar(value)}" for key, value in row.items()]
    end = last_line(last) + 1
    if lines[end - 1][-1:] != "\n":
        lines[end - 1] += "\n"
    margin = " " * messages.start_mark.column
    return edited(lines, [_addition(end, margin, entries, flow=bool(last.flow_style))])


def _addition(end: int, margin: str, entries: list[str], *, flow: bool) -> Edit:
    if flow:
        return end, end, [f"{margin}- {{{', '.join(entries)}}}\n"]
    first, *others = entries
    return end, end, [f"{margin}- {first}\n", *(f"{margin}  {entry}\n" for entry in others)]
