"""What the page on targets says that a target sees is what there is."""

from __future__ import annotations

import dataclasses
import enum
import inspect
import re

from page import ROOT

from roverlink.generator.emit import targets
from roverlink.generator.ir import interfaces, model

_PAGE = (ROOT / "docs" / "targets.md").read_text(encoding="utf-8")


def _documented() -> dict[str, list[tuple[str, str]]]:
    """Name and type of each part of each class of the page."""
    sections = re.split(r"^### (\w+)$", _PAGE, flags=re.MULTILINE)[1:]
    rows = re.compile(r"^\| `(\w+)(?:\(\))?` \| (?:`(.*?)`)? \|", re.MULTILINE)
    return {
        name: [(part, type.replace("\\|", "|")) for part, type in rows.findall(text)]
        for name, text in zip(sections[::2], sections[1::2])
    }


def test_every_class_of_the_bridge_is_on_the_page() -> None:
    """Whoever writes a template finds every class with every field, and its type."""
    classes = {
        name: cls
        for module in (model, interfaces)
        for name, cls in vars(module).items()
        if inspect.isclass(cls) and cls.__module__ == module.__name__
    }
    documented = _documented()
    assert documented.keys() == classes.keys()
    for name, cls in classes.items():
        if issubclass(cls, enum.Enum):
            assert [part for part, _ in documented[name]] == [member.name for member in cls]
        else:
            fields = [(field.name, field.type) for field in dataclasses.fields(cls)]
            assert documented[name][: len(fields)] == fields, name


def test_every_target_is_on_the_page() -> None:
    """The targets that come with the project are listed."""
    listed = re.findall(r"^\| `(\w+)` \| `", _PAGE, re.MULTILINE)
    assert set(targets.names()) <= set(listed)
