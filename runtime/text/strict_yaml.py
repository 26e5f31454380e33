"""YAML that people write, on the command line or in a file: PyYAML, and what it lets through or passes over.

It takes the last of two values with one key and is silent about the other, and raises whatever its own look-ups and
conversions raise where a tag promises what is not there.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

_MERGE = "tag:yaml.org,2002:merge"
_NULL = "tag:yaml.org,2002:null"
_LARGEST = 2**64  # of whole numbers; larger ones fit nothing that is asked for, and Python does not print all of them
_SHOWN = 40  # characters of a value in a message


class YamlTextError(ValueError):
    """What is wrong with a text, and where."""

    def __init__(self, problem: str, mark: yaml.Mark | None = None) -> None:
        super().__init__(problem)
        self._place = f":{mark.line + 1}:{mark.column + 1}" if mark else ""

    def in_file(self, path: Path) -> str:
        """The same of a file's text: path, line and column, and what is wrong there."""
        return f"{path}{self._place}: {self}"


def load(text: str) -> Any:
    """The values of a text. Raises `YamlTextError`."""
    node = compose(text)
    for inner in _nodes(node):
        if isinstance(inner, yaml.ScalarNode):
            construct(inner)
    return construct(node)


def compose(text: str) -> yaml.Node:
    """A text as nodes; what ``<<`` merges stands in each mapping before what is its own.

    Raises `YamlTextError` for what is no YAML, and for a key that stands twice in a mapping.
    """
    try:
        root = yaml.compose(text, yaml.SafeLoader)
        if root is None:
            start = yaml.Mark("", 0, 0, 0, None, 0)
            return yaml.ScalarNode(_NULL, "", start, start)
        mappings = [node for node in _nodes(root) if isinstance(node, yaml.MappingNode)]
        for mapping in mappings:
            _check_keys(mapping)
        for mapping in mappings:
            yaml.constructor.SafeConstructor().flatten_mapping(mapping)
    except yaml.MarkedYAMLError as error:
        raise YamlTextError(f"no YAML: {error.problem or error.context}", error.problem_mark) from error
    except yaml.YAMLError as error:
        raise YamlTextError(f"no YAML: {error}") from error
    except RecursionError as error:
        raise YamlTextError("nested too deeply") from error
    return root


def construct(node: yaml.Node) -> Any:
    """What YAML makes of a node. Raises `YamlTextError` where that is nothing, such as the 30th of February."""
    try:
        value = yaml.constructor.SafeConstructor().construct_document(node)
    # PyYAML looks up, matches and converts what a tag promises, and lets through how that fails
    except (yaml.YAMLError, ValueError, LookupError, AttributeError, TypeError) as error:
        raise YamlTextError(f"YAML makes nothing of {said(node)}", node.start_mark) from error
    if isinstance(value, int) and abs(value) > _LARGEST:
        raise YamlTextError(f"{said(node)} is too large", node.start_mark)
    return value


def said(node: yaml.Node) -> str:
    """A node for messages: as it is written, or what kind of thing it is."""
    if isinstance(node, yaml.MappingNode):
        return "a mapping"
    if isinstance(node, yaml.SequenceNode):
        return f"a list of {len(node.value)}"
    text = str(node.value)
    shown = text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."
    is_quoted = isinstance(node, yaml.ScalarNode) and node.style is not None
    return repr(shown) if is_quoted else shown or "nothing"


def _nodes(root: yaml.Node) -> Iterator[yaml.Node]:
    """Each node once, however many aliases it has."""
    seen: set[int] = set()
    waiting = deque([root])
    while waiting:
        node = waiting.popleft()
        if id(node) in seen:
            continue
        seen.add(id(node))
        yield node
        if isinstance(node, yaml.MappingNode):
            waiting.extend(part for pair in node.value for part in pair)
        elif isinstance(node, yaml.SequenceNode):
            waiting.extend(node.value)


def _check_keys(mapping: yaml.MappingNode) -> None:
    """Raise `YamlTextError` for a key that stands there twice, or is neither a name nor a number."""
    keys: set[Any] = set()
    for key, _ in mapping.value:
        if not isinstance(key, yaml.ScalarNode):
            raise YamlTextError(f"a key is {said(key)}, and no name and no number", key.start_mark)
        value = key.value if key.tag == _MERGE else construct(key)
        if value in keys:
            raise YamlTextError(f"the key {said(key)} stands twice in one mapping; keep one of them", key.start_mark)
        keys.add(value)
