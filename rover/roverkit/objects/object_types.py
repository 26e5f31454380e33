"""File `classes.yaml`: names of a detector's classes, and the types of objects that they are for the basestation.

    names: [rock, small rock, e-stop]       # in the order of the model; only if its file has none
    types:
      small rock: OBJECT_ROCK
      e-stop: OBJECT_MAIN_SWITCH

Types are the names of the enum in the proto. A class without an entry is the type of its own name, such as OBJECT_ROCK
for `rock`. If there is none, the object is of the type 0, which is unknown.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from roverkit.vision.yaml_file import Item, read_file
from roverlink.runtime.core.errors import nearest

UNKNOWN = 0
"""Type of an object of another class: the first value of an enum in proto3."""


@dataclass(frozen=True, slots=True)
class ClassesFile:
    """Content of the file."""

    names: tuple[str, ...] | None = None
    """Names of the classes in the order of the model; None if the model names them."""
    types: Mapping[str, Item] = field(default_factory=dict)
    """Names of types by the names of the classes."""


def read_classes(path: Path) -> ClassesFile:
    """Read the file. Raises `SetupError`, with line and column, for a mistake in it."""
    entries = read_file(path, "classes").known_entries({"names", "types"})
    names = class_names(entries["names"]) if "names" in entries else None
    types = (
        {str(name): item for name, item in entries["types"].entries("type of").items()} if "types" in entries else {}
    )
    return ClassesFile(names, types)


class ObjectTypes:
    """Types of objects by the names of their classes."""

    def __init__(
        self, file: ClassesFile, numbers: Mapping[str, int], classes: tuple[str, ...], say: Callable[[str], None]
    ) -> None:
        """Look up the types of the file; `numbers` are those of the enum's values by their names.

        `classes` are those of the detector, if it names them. `say` is called with a message when a class without a
        type is seen first. Raises `SetupError` if the file names a type or a class that does not exist.
        """
        self._numbers, self._say = numbers, say
        self._types: dict[str, int] = {}
        for name, item in file.types.items():
            if item.text is None or item.text not in numbers:
                raise item.error(f"{item.name} is {item.shown}; {nearest(str(item.text), sorted(numbers))}")
            if classes and name not in classes:
                raise item.error(f"the detector has no class {name!r}; {nearest(name, sorted(classes))}")
            self._types[name] = numbers[item.text]
        words = zip(*(name.split("_") for name in numbers))
        self._prefix = "_".join(
            column[0] for column in itertools.takewhile(lambda column: len(set(column)) == 1, words)
        )

    def of(self, name: str) -> int:
        """Return the type of the objects of a class."""
        if name not in self._types:
            plain = "_".join(name.upper().replace("-", " ").split())
            known = self._numbers.get(plain, self._numbers.get(f"{self._prefix}_{plain}"))
            if known is None:
                self._say(
                    f"objects of the class {name!r} are sent as unknown; add a line to the types in --classes FILE"
                )
            self._types[name] = UNKNOWN if known is None else known
        return self._types[name]


def class_names(item: Item) -> tuple[str, ...]:
    """Return the names of classes: a list, or a mapping from 0, 1, ... as in the data.yaml of a YOLO data set.

    Raises `SetupError` for anything else.
    """
    if item.is_mapping:
        entries = item.entries()
        if list(entries) != list(range(len(entries))):
            raise item.error("the keys of names are not 0, 1, 2 and so on, in this order")
        items = list(entries.values())
    else:
        items = item.items("a name of a class") or []
    names = [item.text for item in items]
    if not names or any(name is None for name in names) or len(set(names)) < len(names):
        raise item.error("names is not a list of different names, such as [rock, socket]")
    return tuple(str(name) for name in names)
