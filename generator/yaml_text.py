"""The text of a YAML file where it is edited in place: comments and layout stay."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import yaml
from yaml.nodes import CollectionNode, MappingNode, Node

Edit = tuple[int, int, list[str]]
"""Lines from the first to before the last, counted from 0, become other lines."""

_MARKS = frozenset("{}[],:#&*!|>'\"%@`")


def edited(lines: list[str], edits: Iterable[Edit]) -> str:
    """The text after edits that do not overlap."""
    # From the end to the start, so that the places of what is still to be changed stay true.
    for first, last, replacement in sorted(edits, key=lambda edit: edit[0], reverse=True):
        lines[first:last] = replacement
    return "".join(lines)


def value_of(node: Node | None, key: str) -> Node | None:
    """The value of a mapping's key; None where there is none."""
    if isinstance(node, MappingNode):
        for key_node, value in node.value:
            if key_node.value == key:
                return value  # type: ignore[no-any-return]  # yaml does not type its nodes' values
    return None


def last_line(node: Node) -> int:
    """The last line with something of a node; a block's own end is where the next thing starts."""
    if not isinstance(node, CollectionNode) or node.flow_style or not node.value:
        return int(node.end_mark.line)
    return max(last_line(part) for part in _parts(node))


def _parts(node: Node) -> Iterator[Node]:
    for part in node.value:
        yield from part if isinstance(part, tuple) else [part]


def scalar(text: str) -> str:
    """A text as YAML reads it back; in quotes where it would be taken for something else."""
    return quoted(text) if not text or set(text) & _MARKS or yaml.safe_load(text) != text else text


def quoted(text: str) -> str:
    """A text in double quotes."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
