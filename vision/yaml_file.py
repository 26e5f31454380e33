"""A YAML file that people write: its values, each with its place for whoever has to correct it."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from runtime.errors import SetupError, nearest
from vision.camera import Floats

_MERGE = "tag:yaml.org,2002:merge"
_NULL = "tag:yaml.org,2002:null"


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
    def value(self) -> Any:
        """What YAML makes of it. Raises `SetupError` where that is nothing, such as the 30th of February."""
        try:
            return yaml.constructor.SafeConstructor().construct_document(self.node)
        except (yaml.YAMLError, ValueError) as error:
            raise self.error(f"{self.name} cannot be read: {getattr(error, 'problem', None) or error}") from error

    @property
    def is_mapping(self) -> bool:
        """Whether it has keys."""
        return isinstance(self.node, yaml.MappingNode)

    def entries(self, kind: str = "") -> dict[Any, Item]:
        """The values of a mapping by their keys; messages call each by its key, with the `kind` of thing before it.

        Raises `SetupError` for what is no mapping, and for a key that stands there twice.
        """
        start = f"{kind} " if kind else f"{self.name}: "
        return {key.value: Item(self.path, node, f"{start}{key.value}") for key, node in self._pairs()}

    def known_entries(self, known: Collection[str]) -> dict[str, Item]:
        """As `entries`, of a mapping that may have these keys. Raises `SetupError` for any other, too."""
        for key, _ in self._pairs():
            if key.value not in known:
                suggestion = nearest(str(key.value), sorted(known))
                raise key.error(f"{self.name} has an unknown key {key.value!r}; {suggestion}")
        return self.entries()

    def _pairs(self) -> list[tuple[Item, yaml.Node]]:
        """Keys and values, first those that `<<` merges, to which the mapping's own are preferred."""
        if not isinstance(self.node, yaml.MappingNode):
            raise self.error(f"{self.name} is no mapping")
        own = set()
        for key in (self._key(node) for node, _ in self.node.value if node.tag != _MERGE):
            if key.value in own:
                raise key.error(f"{self.name} has the key {key.value!r} twice; keep one of them")
            own.add(key.value)
        merged = yaml.MappingNode(self.node.tag, list(self.node.value))
        try:
            yaml.constructor.SafeConstructor().flatten_mapping(merged)
        except yaml.YAMLError as error:
            raise self.error(f"{self.name} merges by << what is no mapping") from error
        return [(self._key(key), value) for key, value in merged.value]

    def _key(self, node: yaml.Node) -> Item:
        key = Item(self.path, node, f"a key of {self.name}")
        if not isinstance(node, yaml.ScalarNode):
            raise key.error(f"{key.name} is no name and no number")
        return key

    @property
    def text(self) -> str | None:
        """What stands there, as it stands there; None of a mapping or a list."""
        return str(self.node.value) if isinstance(self.node, yaml.ScalarNode) else None

    def items(self, name: str) -> list[Item] | None:
        """The values of a list, each of that name; None of anything else."""
        if not isinstance(self.node, yaml.SequenceNode):
            return None
        return [Item(self.path, node, name) for node in self.node.value]

    def numbers(self, count: int) -> Floats:
        """A list of so many finite numbers. Raises `SetupError` for anything else."""
        found = self.value if isinstance(self.value, list) else []
        if len(found) != count or any(isinstance(one, bool) or not isinstance(one, int | float) for one in found):
            raise self.error(f"{self.name} is {self.value!r}; it is a list of {count} numbers")
        if not all(math.isfinite(one) for one in found):
            raise self.error(f"{self.name} is {self.value!r}; the numbers must be finite")
        return np.array(found, dtype=float)


def read_file(path: Path, what: str) -> Item:
    """The whole of a file of `what`. Raises `SetupError` for one that is missing or no YAML."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise SetupError(f"cannot read the {what}: {error}") from error
    return parse(path, text)


def parse(path: Path, text: str) -> Item:
    """The whole of a file's text. Raises `SetupError` for what is no YAML."""
    try:
        node = yaml.compose(text, yaml.SafeLoader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f"{path}:{mark.line + 1}:{mark.column + 1}" if mark else str(path)
        raise SetupError(f"{where}: no YAML: {getattr(error, 'problem', None) or error}") from error
    except RecursionError as error:
        raise SetupError(f"{path}: nested too deeply") from error
    if node is None:
        start = yaml.Mark(str(path), 0, 0, 0, None, 0)
        node = yaml.ScalarNode(_NULL, "", start, start)
    return Item(path, node, "the file")
