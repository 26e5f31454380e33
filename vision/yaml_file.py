"""A YAML file that people write: its values, each with its place for whoever has to correct it."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from runtime.errors import SetupError, nearest
from vision.camera import Floats

_MERGE = "tag:yaml.org,2002:merge"
_NULL = "tag:yaml.org,2002:null"
_LARGEST = 2**64  # of whole numbers: nothing here counts so far, and larger ones fit no float or no message
_SHOWN = 40  # characters of a value in a message


@dataclass(frozen=True, slots=True, eq=False)
class Item:
    """A value in a file. What it holds is looked at where it is asked for."""

    path: Path
    node: yaml.Node
    name: str
    """What messages call it."""

    def error(self, message: str) -> SetupError:
        """An error that says where this stands: file, line and column."""
        mark = self.node.start_mark
        return SetupError(f"{self.path}:{mark.line + 1}:{mark.column + 1}: {message}")

    @property
    def said(self) -> str:
        """What stands there, for messages: as it is written, or what kind of thing it is."""
        if isinstance(self.node, yaml.MappingNode):
            return "a mapping"
        if isinstance(self.node, yaml.SequenceNode):
            return f"a list of {len(self.node.value)}"
        text = str(self.node.value)
        shown = text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."
        is_quoted = isinstance(self.node, yaml.ScalarNode) and self.node.style is not None
        return repr(shown) if is_quoted else shown or "nothing"

    @property
    def value(self) -> Any:
        """What YAML makes of it. Raises `SetupError` where that is nothing, such as the 30th of February."""
        try:
            value = yaml.constructor.SafeConstructor().construct_document(self.node)
        # PyYAML looks up, matches and converts what a tag promises, and lets through how that fails
        except (yaml.YAMLError, ValueError, LookupError, AttributeError, TypeError) as error:
            raise self.error(f"{self.name} is {self.said}, of which YAML makes nothing") from error
        if isinstance(value, int) and abs(value) > _LARGEST:
            raise self.error(f"{self.name} is {self.said}, which is too large")
        return value

    @property
    def text(self) -> str | None:
        """What stands there, letter by letter; None of a mapping or a list."""
        return str(self.node.value) if isinstance(self.node, yaml.ScalarNode) else None

    @property
    def number(self) -> float:
        """The number that stands there; nan where none does."""
        value = self.value
        return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else math.nan

    @property
    def is_mapping(self) -> bool:
        """Whether it has keys."""
        return isinstance(self.node, yaml.MappingNode)

    def entries(self, kind: str = "") -> dict[Any, Item]:
        """The values of a mapping by their keys; messages call each by its key, with the `kind` of thing before it.

        Raises `SetupError` for what is no mapping.
        """
        start = f"{kind} " if kind else f"{self.name}: "
        return {key.value: Item(self.path, node, f"{start}{key.text}") for key, node in self._pairs()}

    def known_entries(self, known: Collection[str]) -> dict[str, Item]:
        """As `entries`, of a mapping that may have these keys. Raises `SetupError` for any other, too."""
        for key, _ in self._pairs():
            if key.value not in known:
                raise key.error(f"{self.name} has an unknown key {key.text!r}; {nearest(str(key.text), sorted(known))}")
        return self.entries()

    def _pairs(self) -> Iterator[tuple[Item, yaml.Node]]:
        """Keys and values; the later of two with the same key counts."""
        if not isinstance(self.node, yaml.MappingNode):
            raise self.error(f"{self.name} is no mapping")
        for key, value in self.node.value:
            yield Item(self.path, key, f"a key of {self.name}"), value

    def items(self, name: str) -> list[Item] | None:
        """The values of a list, each of that name; None of anything else."""
        if not isinstance(self.node, yaml.SequenceNode):
            return None
        return [Item(self.path, node, name) for node in self.node.value]

    def numbers(self, count: int) -> Floats:
        """A list of so many finite numbers. Raises `SetupError` for anything else."""
        items = self.items(f"a number of {self.name}")
        if items is None or len(items) != count:
            raise self.error(f"{self.name} is {self.said}; it is a list of {count} numbers")
        for item in items:
            if not math.isfinite(item.number):
                raise item.error(f"{item.name} is {item.said}; it is a finite number")
        return np.array([item.number for item in items])


def read_file(path: Path, what: str) -> Item:
    """The whole of a file of `what`. Raises `SetupError` for one that is missing, or that `parse` refuses."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise SetupError(f"cannot read the {what}: {error}") from error
    return parse(path, text)


def parse(path: Path, text: str) -> Item:
    """The whole of a file's text; what `<<` merges stands in each mapping before what is its own.

    Raises `SetupError` for what is no YAML, and for a key that stands twice in a mapping.
    """
    try:
        root = yaml.compose(text, yaml.SafeLoader)
        if root is None:
            start = yaml.Mark(str(path), 0, 0, 0, None, 0)
            root = yaml.ScalarNode(_NULL, "", start, start)
        mappings = list(_mappings(root))
        for mapping in mappings:
            _check_keys(Item(path, mapping, "the file"))
        for mapping in mappings:
            yaml.constructor.SafeConstructor().flatten_mapping(mapping)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f"{path}:{mark.line + 1}:{mark.column + 1}" if mark else str(path)
        raise SetupError(f"{where}: no YAML: {getattr(error, 'problem', None) or error}") from error
    except RecursionError as error:
        raise SetupError(f"{path}: nested too deeply") from error
    return Item(path, root, "the file")


def _mappings(root: yaml.Node) -> Iterator[yaml.MappingNode]:
    """Each mapping once, however many aliases it has."""
    seen: set[int] = set()
    waiting = deque([root])
    while waiting:
        node = waiting.popleft()
        if id(node) in seen or isinstance(node, yaml.ScalarNode):
            continue
        seen.add(id(node))
        if isinstance(node, yaml.MappingNode):
            yield node
            waiting.extend(part for pair in node.value for part in pair)
        else:
            waiting.extend(node.value)


def _check_keys(mapping: Item) -> None:
    """Raise `SetupError` for a key that stands there twice, or is neither a name nor a number."""
    keys: set[Any] = set()
    for node, _ in mapping.node.value:
        key = Item(mapping.path, node, "a key")
        if not isinstance(node, yaml.ScalarNode):
            raise key.error(f"a key is {key.said}, and no name and no number")
        value = node.value if node.tag == _MERGE else key.value
        if value in keys:
            raise key.error(f"the key {key.said} stands twice in one mapping; keep one of them")
        keys.add(value)
