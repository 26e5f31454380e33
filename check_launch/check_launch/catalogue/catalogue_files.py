"""The catalogues as files, one JSON file for each ROS 2 distribution, sorted and with one fact on each line."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from check_launch.catalogue.facts import (
    Catalogue,
    Endpoint,
    NodeClass,
    Package,
    Parameter,
    ParameterSet,
    Plugin,
    PluginSlot,
    SharedParameters,
    Source,
    SubNode,
    Transform,
)

DISTRIBUTIONS = ("humble", "jazzy")
"""ROS 2 distributions for which there is a catalogue."""

_FOLDER = Path(__file__).parent


def file_of(distribution: str) -> Path:
    """Return the path of the catalogue of a distribution."""
    return _FOLDER / f"{distribution}.json"


@cache
def read_catalogue(distribution: str) -> Catalogue:
    """Read the catalogue of one of `DISTRIBUTIONS`."""
    data = json.loads(file_of(distribution).read_text(encoding="utf-8"))
    return Catalogue(
        data["distribution"],
        {name: Source(**one) for name, one in data["sources"].items()},
        {
            name: Package(
                name, one["version"], one["source"], one["executables"], tuple(one["components"]), one["launch_files"]
            )
            for name, one in data["packages"].items()
        },
        {name: _class(name, one) for name, one in data["classes"].items()},
        {
            name: Plugin(**{**one, "message_types": tuple(one.get("message_types", ()))})
            for name, one in data["plugins"].items()
        },
        {name: ParameterSet(_parameters(one["parameters"]), one["renamed"]) for name, one in data["sets"].items()},
    )


def _class(name: str, data: Mapping[str, Any]) -> NodeClass:
    return NodeClass(
        name,
        data.get("default_name", ""),
        _parameters(data.get("parameters", {})),
        _parameters(data.get("of_node", {})),
        _parameters(data.get("of_parent", {})),
        tuple(Endpoint(**one) for one in data.get("endpoints", ())),
        tuple(PluginSlot(**{**one, "spellings": tuple(one.get("spellings", ()))}) for one in data.get("slots", ())),
        tuple(SubNode(**one) for one in data.get("nodes", ())),
        tuple(Transform(**one) for one in data.get("transforms", ())),
        tuple(data.get("frames", ())),
        tuple(
            SharedParameters(one["set"], tuple(one.get("groups", ())), tuple(one.get("without", ())))
            for one in data.get("shared", ())
        ),
        data.get("has_open_topics", False),
        data.get("arguments", {}),
    )


def _parameters(data: Mapping[str, Any]) -> dict[str, Parameter]:
    return {name: Parameter(**{**one, "choices": tuple(one.get("choices", ()))}) for name, one in data.items()}


def text_of(catalogue: Catalogue) -> str:
    """Return the text of a catalogue's file. Values that are the same as the default of their field are left out."""
    data = {
        "distribution": catalogue.distribution,
        "sources": {name: dataclasses.asdict(one) for name, one in catalogue.sources.items()},
        "packages": {name: _short(one, without=("name",)) for name, one in catalogue.packages.items()},
        "classes": {name: _short(one, without=("name",), optional=True) for name, one in catalogue.classes.items()},
        "plugins": {name: _short(one) for name, one in catalogue.plugins.items()},
        "sets": {name: _short(one) for name, one in catalogue.sets.items()},
    }
    return _text(data, 0) + "\n"


def _short(value: Any, without: tuple[str, ...] = (), optional: bool = False) -> Any:
    if dataclasses.is_dataclass(value):
        is_fact = optional or not isinstance(value, Package | ParameterSet)
        pairs = ((field.name, getattr(value, field.name)) for field in dataclasses.fields(value))
        return {
            name: _short(one)
            for name, one in pairs
            if name not in without
            and (not is_fact or one not in ("", None, (), {}) or ((name == "default" and one == "") and one != ""))
            and not (is_fact and one is False and name in ("is_type", "has_open_topics"))
        } | ({"default": ""} if isinstance(value, Parameter) and value.default == "" else {})
    if isinstance(value, Mapping):
        return {name: _short(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_short(one) for one in value]
    return value


def _text(value: Any, depth: int) -> str:
    """Return JSON with one line for each object that holds no other object."""
    is_leaf = not isinstance(value, dict | list) or not any(
        isinstance(one, dict | list) and one for one in (value.values() if isinstance(value, dict) else value)
    )
    flat = json.dumps(value, ensure_ascii=False)
    if (is_leaf and len(flat) < 400) or not value:
        return flat
    indent, end = " " * (depth + 1), " " * depth
    if isinstance(value, dict):
        inner = [
            f"{indent}{json.dumps(name, ensure_ascii=False)}: {_text(one, depth + 1)}" for name, one in value.items()
        ]
        return "{\n" + ",\n".join(inner) + f"\n{end}}}"
    return "[\n" + ",\n".join(f"{indent}{_text(one, depth + 1)}" for one in value) + f"\n{end}]"
