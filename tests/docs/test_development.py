"""docs/development.md names what is there: the functions of the walk, the folders, the targets of make."""

from __future__ import annotations

import importlib
import re

import pytest
from page import ROOT

_TEXT = (ROOT / "docs" / "development.md").read_text(encoding="utf-8")
_NAMED = re.findall(r"`((?:generated|generator|roverlink|runtime)[\w.]*):([\w.]+)`", _TEXT)


@pytest.mark.parametrize(("module", "name"), sorted(set(_NAMED)))
def test_what_the_walk_names_exists(module: str, name: str) -> None:
    """`module:name` can be imported."""
    found: object = importlib.import_module(module)
    for part in name.split("."):
        found = getattr(found, part)


def test_the_walk_names_something() -> None:
    """The pattern above finds the names."""
    assert len(_NAMED) > 20


def test_what_stands_in_back_quotes_as_a_path_exists() -> None:
    """Files and folders of the project that the page names are there."""
    paths = re.findall(r"`((?:generated|generator|roverlink|runtime|templates|tests|proto)/[\w./]*)`", _TEXT)

    assert [path for path in paths if not (ROOT / path).exists()] == []


def test_the_targets_of_make_exist() -> None:
    """Every `make` target that the page uses is one of the Makefile's."""
    targets = set(re.findall(r"^([a-z0-9-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))

    assert set(re.findall(r"make ([a-z0-9-]+)`", _TEXT)) <= targets
