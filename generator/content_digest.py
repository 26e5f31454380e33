"""Values and digests of the table and of .proto files, where the compiler would take too long.

Digests do not depend on comments, layout and the order of rows. The generated code holds the digests of the files that
it was compiled from. So `roverlink run` sees without a compilation that a file has changed since then.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import yaml

from roverlink import bounded_files
from roverlink.bounded_yaml import FAST_LOADER

_LENGTH = 16  # hexadecimal digits: 64 bits, because nobody attacks a file of his own
_PROTO_TOKEN = re.compile(
    r"""//[^\n]*|/\*.*?\*/|("(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|\w+|\S)""", re.DOTALL
)  # comments have no group


def proto_digest(text: str) -> str:
    """Return the digest of the tokens of a .proto file."""
    return _digest(filter(None, _PROTO_TOKEN.findall(text)))


def table_digest(text: str) -> str:
    """Return the digest of the values in a table. Raises `yaml.YAMLError` if the text is not YAML."""
    return _node_digest(yaml.compose(text, FAST_LOADER), {})


def text_at(table: Path, *keys: str) -> str:
    """Return the text at a path of keys in a table; empty if there is none, or if the table cannot be read.

    The generator's reader of tables checks the whole table, which takes as long as all other steps of a start.
    """
    try:
        node: Any = yaml.compose(bounded_files.read(table), FAST_LOADER)
        for key in keys:
            node = next(value for name, value in node.value if name.value == key)
    except (OSError, yaml.YAMLError, StopIteration, AttributeError, TypeError, ValueError, RecursionError):
        return ""
    return str(node.value) if isinstance(node, yaml.ScalarNode) else ""


def _node_digest(node: yaml.Node | None, known: dict[int, str]) -> str:
    """Return the digest of a node. ``known`` has those of aliased nodes, which may contain themselves."""
    if id(node) in known:
        return known[id(node)]
    known[id(node)] = ""
    if isinstance(node, yaml.MappingNode):
        parts = sorted(f"{_node_digest(key, known)}:{_node_digest(value, known)}" for key, value in node.value)
    elif isinstance(node, yaml.SequenceNode):
        parts = [_node_digest(part, known) for part in node.value]
        if any(isinstance(part, yaml.MappingNode) for part in node.value):  # rows and peers, which have no order
            parts.sort()
    else:
        parts = [node.value] if node else []
    known[id(node)] = _digest([node.tag if node else "", *parts])
    return known[id(node)]


def _digest(parts: Iterable[str]) -> str:
    return hashlib.sha256("\0".join(parts).encode("utf-8", "surrogatepass")).hexdigest()[:_LENGTH]
