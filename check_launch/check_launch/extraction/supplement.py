"""Reader of supplement.yaml: facts that no source states in a form that the program can extract."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from check_launch.expansion.entities import FAST_LOADER

_FILE = Path(__file__).with_name("supplement.yaml")


@dataclass(frozen=True, slots=True)
class Supplement:
    """The sections of the file, by the names of classes, and `programs` by ``package/executable``."""

    names: Mapping[str, Mapping[str, Any]]
    slots: Mapping[str, list[dict[str, Any]]]
    nodes: Mapping[str, list[dict[str, str]]]
    parts: Mapping[str, list[str]]
    programs: Mapping[str, str]
    parameters: Mapping[str, Mapping[str, dict[str, Any]]]
    absent: Mapping[str, list[str]]
    topics: Mapping[str, list[dict[str, Any]]]
    transforms: Mapping[str, list[dict[str, str]]]
    frames: Mapping[str, list[str]]
    sets: Mapping[str, dict[str, Any]]
    arguments: Mapping[str, Mapping[str, str]]
    open_topics: list[str]
    """Classes of nodes whose topics a file decides."""
    launch_files: list[str]
    """Packages whose launch files others include, so that the catalogue describes them."""


def read_supplement() -> Supplement:
    """Read the file."""
    return Supplement(**yaml.load(_FILE.read_text(encoding="utf-8"), FAST_LOADER))  # noqa: S506  # a safe loader
