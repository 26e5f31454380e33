"""A YAML file that people write: its values, each with its place for whoever has to correct it."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.text.strict_yaml import YamlTextError, compose, construct, said
from roverlink.vision.camera.camera_model import Floats

LARGEST = 1e9
"""No length in metres, angle in degrees or parameter of a camera is as large."""


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
        return said(self.node)

    @property
    def value(self) -> Any:
        """What YAML makes of it. Raises `SetupError` where that is nothing, such as the 30th of February."""
        try:
            return construct(self.node)
        except YamlTextError as error:
            raise self.error(f"{self.name}: {error}") from error

    @property
    def text(self) -> str | None:
        """What stands there, letter by letter; None of a mapping or a list."""
        return str(self.node.value) if isinstance(self.node, yaml.ScalarNode) else None

    @property
    def number(self) -> float:
        """The number that stands there; nan where none does. Raises `SetupError` for one that nothing here can be."""
        value = self.value
        number = float(value) if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
        if LARGEST < abs(number) < math.inf:
            raise self.error(f"{self.name} is {self.said}, which is too large")
        return number

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
        numbers = []
        for item in items:
            number = item.number
            if not math.isfinite(number):
                raise item.error(f"{item.name} is {item.said}; it is a finite number, such as 0.5 or 1.0e-3")
            numbers.append(number)
        return np.array(numbers)


def read_file(path: Path, what: str) -> Item:
    """The whole of a file of `what`. Raises `SetupError` for one that is missing, or that `parse` refuses."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise SetupError(f"cannot read the {what}: {error}") from error
    return parse(path, text)


def parse(path: Path, text: str) -> Item:
    """The whole of a file's text. Raises `SetupError` for what is no YAML, and for a key that stands twice."""
    try:
        return Item(path, compose(text), "the file")
    except YamlTextError as error:
        raise SetupError(error.in_file(path)) from error
