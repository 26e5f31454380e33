"""Strict reader of YAML for files and command lines: PyYAML, with checks for errors that PyYAML ignores.

If a key occurs twice, PyYAML silently keeps the last value. And if a value cannot be converted to the type of its tag,
PyYAML may raise any kind of exception. A text from a stranger must cost neither seconds nor gigabytes. Therefore the
levels, the digits of a number, and the entries that ``<<`` merges have limits.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from roverlink.bounded_yaml import BoundedLoader

_MERGE = "tag:yaml.org,2002:merge"
_NULL = "tag:yaml.org,2002:null"
_LARGEST = 2**64  # largest integer; a larger one fits no field, and Python refuses to print those above 4300 digits
_LONGEST_NUMBER = 400  # characters; a double needs 309 digits at most, and Python needs seconds for many more
_NUMBERS = ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float")
_MOST_MERGED = 10_000  # entries of a mapping; with merges of merges, a short text has billions
_SHOWN = 40  # characters of a value in a message


class YamlTextError(ValueError):
    """Error in a YAML text, with line and column."""

    def __init__(self, problem: str, mark: yaml.Mark | None = None) -> None:
        super().__init__(problem)
        self._place = f":{mark.line + 1}:{mark.column + 1}" if mark else ""

    def in_file(self, path: Path) -> str:
        """Return the error message with file, line and column in front: ``params.yaml:3:5: not valid YAML: ...``."""
        return f"{path}{self._place}: {self}"


def load(text: str) -> Any:
    """Parse a YAML text into plain Python values. Raises `YamlTextError` if the text is not valid."""
    node = compose(text)
    # Each scalar by itself first, so that an error has the place of the scalar and not that of the whole document.
    for inner in _nodes(node):
        if isinstance(inner, yaml.ScalarNode):
            construct(inner)
    return construct(node)


def compose(text: str) -> yaml.Node:
    """Parse a YAML text into nodes. Keys that ``<<`` merges into a mapping come before the mapping's own keys.

    Raises `YamlTextError` for invalid YAML and for a key that occurs twice in a mapping.
    """
    try:
        root = yaml.compose(text, BoundedLoader)
        if root is None:
            # An empty text has no node for yaml.compose, but it is a valid document: null.
            start = yaml.Mark("", 0, 0, 0, None, 0)
            return yaml.ScalarNode(_NULL, "", start, start)
        nodes = [*_nodes(root)]
        for node in nodes:
            if isinstance(node, yaml.ScalarNode):
                _check_scalar(node)
        mappings = [node for node in nodes if isinstance(node, yaml.MappingNode)]
        for mapping in mappings:
            _check_keys(mapping)
        for mapping in mappings:
            _Constructor().flatten_mapping(mapping)
    except yaml.MarkedYAMLError as error:
        raise YamlTextError(f"not valid YAML: {error.problem or error.context}", error.problem_mark) from error
    except yaml.YAMLError as error:
        raise YamlTextError(f"not valid YAML: {error}") from error
    except RecursionError as error:
        raise YamlTextError("a mapping merges itself") from error
    return root


def construct(node: yaml.Node) -> Any:
    """Convert a YAML node to a plain Python value. Raises `YamlTextError` if that is impossible, as for 2024-02-30."""
    try:
        value = _Constructor().construct_document(node)
    # PyYAML's constructors look up, match and convert without catching the errors of these operations.
    except (yaml.YAMLError, ValueError, LookupError, AttributeError, TypeError) as error:
        raise YamlTextError(f"{shown(node)} is not a valid value", node.start_mark) from error
    if isinstance(value, int) and abs(value) > _LARGEST:
        raise YamlTextError(f"{shown(node)} is too large", node.start_mark)
    return value


def shown(node: yaml.Node) -> str:
    """Return a YAML node as text for error messages: a scalar as it is written, "a mapping", or "a list of ..."."""
    if isinstance(node, yaml.MappingNode):
        return "a mapping"
    if isinstance(node, yaml.SequenceNode):
        return f"a list of {len(node.value)}"
    text = str(node.value)
    excerpt = text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."
    is_quoted = isinstance(node, yaml.ScalarNode) and node.style is not None
    return repr(excerpt) if is_quoted else excerpt or "an empty value"


def _nodes(root: yaml.Node) -> Iterator[yaml.Node]:
    """Yield a YAML node and all nodes inside it. Each is yielded once, even if the text refers to it several times."""
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


class _Constructor(yaml.constructor.SafeConstructor):
    def flatten_mapping(self, node: yaml.MappingNode) -> None:
        """Merge the mappings of ``<<`` into a mapping. Raises `YamlTextError` if there are too many entries.

        PyYAML before 6.0.4 copies them all, also those that it has already.
        """
        for key, value in node.value:
            if key.tag == _MERGE and isinstance(value, yaml.SequenceNode):
                merged = [part for part in value.value if isinstance(part, yaml.MappingNode)]
                for part in merged:
                    self.flatten_mapping(part)
                if sum(len(part.value) for part in merged) > _MOST_MERGED:
                    raise YamlTextError(f"<< merges more than {_MOST_MERGED} entries", key.start_mark)
        super().flatten_mapping(node)


def _check_scalar(node: yaml.ScalarNode) -> None:
    """Raise `YamlTextError` for a number that is too long, and for the character NUL, which no file name can have."""
    if node.tag in _NUMBERS and len(node.value) > _LONGEST_NUMBER:
        raise YamlTextError(f"{shown(node)} is too large", node.start_mark)
    if "\0" in node.value:
        raise YamlTextError(f"{shown(node)} has the character NUL", node.start_mark)


def _check_keys(mapping: yaml.MappingNode) -> None:
    """Raise `YamlTextError` if a key of a mapping occurs twice, or if a key is a list or a mapping."""
    keys: set[Any] = set()
    for key, _ in mapping.value:
        if not isinstance(key, yaml.ScalarNode):
            raise YamlTextError(f"a key is {shown(key)}; it must be a name or a number", key.start_mark)
        value = key.value if key.tag == _MERGE else construct(key)
        if value in keys:
            raise YamlTextError(f"the key {shown(key)} occurs twice in one mapping; keep one of them", key.start_mark)
        keys.add(value)
