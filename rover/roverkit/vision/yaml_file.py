"""YAML files that people write, such as `landmarks.yaml`. Each value keeps its line and column for error messages."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from roverkit.vision.camera.camera_model import Floats
from roverlink.bounded_files import read_text
from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.text.strict_yaml import YamlTextError, compose, construct, shown

LARGEST = 1e9
"""Largest absolute value of a number in a file; real lengths, angles and camera parameters are much smaller."""


@dataclass(frozen=True, slots=True, eq=False)
class Item:
    """Value in a YAML file, with its place in the file. It is converted and checked only when the program uses it."""

    path: Path
    node: yaml.Node
    name: str
    """Name of the value in error messages, such as ``landmark 7: position``."""

    def error(self, message: str) -> SetupError:
        """Return an error whose message begins with file, line and column of the value: ``boards.yaml:3:9: ...``."""
        mark = self.node.start_mark
        return SetupError(f"{self.path}:{mark.line + 1}:{mark.column + 1}: {message}")

    @property
    def shown(self) -> str:
        """Value as text for error messages: a scalar as it is written, or else ``a mapping`` or ``a list of 3``."""
        return shown(self.node)

    @property
    def value(self) -> Any:
        """Value as a Python object. Raises `SetupError` if the conversion fails, as for the date ``2024-02-30``."""
        try:
            return construct(self.node)
        except YamlTextError as error:
            raise self.error(f"{self.name}: {error}") from error

    @property
    def text(self) -> str | None:
        """Text of a scalar exactly as it is written; None for a mapping or a list."""
        return str(self.node.value) if isinstance(self.node, yaml.ScalarNode) else None

    @property
    def number(self) -> float:
        """Value as a number; NaN if the value is not a number. Raises `SetupError` if the number is too large."""
        value = self.value
        number = float(value) if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
        if LARGEST < abs(number) < math.inf:
            raise self.error(f"{self.name} is {self.shown}; that is too large (limit: {LARGEST:g})")
        return number

    @property
    def is_mapping(self) -> bool:
        """True if the value is a mapping."""
        return isinstance(self.node, yaml.MappingNode)

    def require(self, fits: bool, what: str) -> None:
        """Raise `SetupError` unless the value fits; the message says that it must be ``what``."""
        if not fits:
            raise self.error(f"{self.name} is {self.shown}; it must be {what}")

    def filled_text(self, what: str = "a text") -> str:
        """Return the value, which must be a text that is not empty. Raises `SetupError` if it is not."""
        value = self.value
        self.require(isinstance(value, str) and bool(value), f"{what} (in quotes if it looks like a number)")
        return str(value)

    def entries(self, kind: str = "") -> dict[Any, Item]:
        """Return the values of a mapping by their keys.

        The name of a returned value in error messages is `kind` and its key, such as ``board gate``. Without `kind`, it
        is the name of this item and the key, such as ``board gate: side``. Raises `SetupError` if this item is not a
        mapping.
        """
        start = f"{kind} " if kind else f"{self.name}: "
        return {key.value: Item(self.path, node, f"{start}{key.text}") for key, node in self._pairs()}

    def known_entries(self, known: Collection[str]) -> dict[str, Item]:
        """Return the values of a mapping by their keys, as `entries` does.

        Raises `SetupError` if this item is not a mapping, or if one of its keys is not in `known`.
        """
        for key, _ in self._pairs():
            if key.value not in known:
                raise key.error(f"{self.name} has an unknown key {key.text!r}; {nearest(str(key.text), sorted(known))}")
        return self.entries()

    def _pairs(self) -> Iterator[tuple[Item, yaml.Node]]:
        """Yield each key of the mapping, as an item, with the YAML node of its value.

        A key can occur twice if ``<<`` merges another mapping into this one. Then the later value counts.
        """
        if not isinstance(self.node, yaml.MappingNode):
            raise self.error(f"{self.name} is not a mapping")
        for key, value in self.node.value:
            yield Item(self.path, key, f"a key of {self.name}"), value

    def items(self, name: str) -> list[Item] | None:
        """Return the elements of a list; None if this item is not a list. Error messages call each element `name`."""
        if not isinstance(self.node, yaml.SequenceNode):
            return None
        return [Item(self.path, node, name) for node in self.node.value]

    def numbers(self, count: int) -> Floats:
        """Return this item as an array of `count` finite numbers.

        Raises `SetupError` if it is not a list of such numbers.
        """
        items = self.items(f"a number of {self.name}")
        self.require(items is not None and len(items) == count, f"a list of {count} numbers")
        numbers = []
        for item in items or ():
            numbers.append(item.number)
            item.require(math.isfinite(numbers[-1]), "a finite number, such as 0.5 or 1.0e-3")
        return np.array(numbers)


def read_file(path: Path, what: str) -> Item:
    """Read a YAML file.

    Raises `SetupError` if the file cannot be read or parsed. `what` names the content of the file in the error message,
    such as ``landmarks``.
    """
    try:
        text = read_text(path)
    except OSError as error:
        raise SetupError(f"{path}: cannot read the {what}: {error.strerror}") from error
    return parse(path, text)


def parse(path: Path, text: str) -> Item:
    """Parse the text of a YAML file. Raises `SetupError` if it is not YAML, or if a key occurs twice in a mapping."""
    return parse_with(compose, path, text)


def parse_with(composer: Callable[[str], yaml.Node], path: Path, text: str) -> Item:
    """Parse the text of a file with a function that raises `YamlTextError`. Raises `SetupError` in its place."""
    try:
        return Item(path, composer(text), "the file")
    except YamlTextError as error:
        raise SetupError(error.in_file(path)) from error
