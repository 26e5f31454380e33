"""Reader of stated_facts.yaml: names that changed between releases, and values that nodes refuse."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import yaml

from check_launch.expansion.entities import FAST_LOADER

_FILE = Path(__file__).with_name("stated_facts.yaml")


@dataclass(frozen=True, slots=True)
class StatedFacts:
    """The sections of the file, by the names of classes."""

    renamed: Mapping[str, Mapping[str, str]]
    """New names by the old ones, by the distribution that changed them."""
    renamed_options: Mapping[str, str]
    renamed_plugins: Mapping[str, str]
    usual_names: Mapping[str, str]
    """Names that programs give to their nodes, by package and executable."""
    lengths: Mapping[str, Mapping[str, list[int]]]
    polygons: Mapping[str, list[str]]
    needed: Mapping[str, Mapping[str, str]]
    """Conditions under which a node needs a parameter, by the pattern of its name; empty for always."""
    tolerated: list[str]
    """Parameters of which a node ignores a value that it does not allow, or uses it as it is."""
    without_lifecycle: list[str]
    tree_nodes: list[str]
    """Libraries with Nav2's nodes of behavior trees."""

    def new_name(self, name: str, is_known: Callable[[str], bool]) -> str:
        """Return what a parameter or argument is called now; empty if it was not renamed, as far as is known.

        ``is_known`` returns true for a name that a node or launch file has today.
        """
        for names in self.renamed.values():
            for old, new in names.items():
                if (name == old or name.endswith(f".{old}")) and is_known(name.removesuffix(old) + new):
                    return name.removesuffix(old) + new
        return ""

    def new_last_part(self, name: str) -> str:
        """Return what the last part of a parameter is called now, wherever it stands; empty if it was not renamed."""
        last = name.rpartition(".")[2]
        return next((names[last] for names in self.renamed.values() if last in names), "")

    def length_of(self, class_name: str, parameter: str) -> list[int]:
        """Return the lengths that a list may have; empty if that is not known."""
        patterns = self.lengths.get(class_name, {}).items()
        return next((lengths for pattern, lengths in patterns if _fits(pattern, parameter)), [])

    def tolerates(self, parameter: str) -> bool:
        """Return true if a node starts with a wrong value of the parameter."""
        return any(_fits(pattern, parameter) for pattern in self.tolerated)


def _fits(pattern: str, parameter: str) -> bool:
    return re.fullmatch(re.escape(pattern).replace(r"\{\#\}", r"\d+"), parameter) is not None


@cache
def stated_facts() -> StatedFacts:
    """Read the file."""
    return StatedFacts(**yaml.load(_FILE.read_text(encoding="utf-8"), FAST_LOADER))  # noqa: S506  # a safe loader
