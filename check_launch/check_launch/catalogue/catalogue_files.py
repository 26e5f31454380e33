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

DISTRIBUTIONS = ("humble", "jazzy", "kilted")
"""ROS 2 distributions for which there is a catalogue."""

_FOLDER = Path(__file__).parent
_NOT_STORED = ("name", "other_texts", "build_words")
"""The name is the key of the facts; the others are of workspaces only."""


NO_CATALOGUE = Catalogue("", {}, {}, {}, {}, {})
"""Facts about no package."""


def file_of(distribution: str) -> Path:
    """Return the path of the catalogue of a distribution."""
    return _FOLDER / f"{distribution}.json"


@cache
def read_catalogue(distribution: str) -> Catalogue:
    """Read the catalogue of one of `DISTRIBUTIONS`."""
    data = json.loads(file_of(distribution).read_text(encoding="utf-8"))
    return Catalogue(
        data["distribution"],
        {name: Source(**source) for name, source in data["sources"].items()},
        {
            name: Package(
                name,
                facts["version"],
                facts["source"],
                facts["executables"],
                facts["components"],
                facts["launch_files"],
                facts.get("is_partial", False),
            )
            for name, facts in data["packages"].items()
        },
        {name: _class(name, facts) for name, facts in data["classes"].items()},
        {
            name: Plugin(**{**plugin, "message_types": tuple(plugin.get("message_types", ()))})
            for name, plugin in data["plugins"].items()
        },
        {
            name: ParameterSet(_parameters(facts["parameters"]), facts["renamed"])
            for name, facts in data["sets"].items()
        },
    )


def _class(name: str, data: Mapping[str, Any]) -> NodeClass:
    return NodeClass(
        name,
        data.get("default_name", ""),
        _parameters(data.get("parameters", {})),
        _parameters(data.get("of_node", {})),
        _parameters(data.get("of_parent", {})),
        tuple(Endpoint(**endpoint) for endpoint in data.get("endpoints", ())),
        tuple(PluginSlot(**{**slot, "spellings": tuple(slot.get("spellings", ()))}) for slot in data.get("slots", ())),
        tuple(SubNode(**{"name": "", "namespace": "", "class_name": "", **node}) for node in data.get("nodes", ())),
        tuple(Transform(**transform) for transform in data.get("transforms", ())),
        tuple(data.get("frames", ())),
        tuple(
            SharedParameters(shared["set"], tuple(shared.get("groups", ())), tuple(shared.get("without", ())))
            for shared in data.get("shared", ())
        ),
        data.get("has_open_topics", False),
        data.get("arguments", {}),
        is_partial=data.get("is_partial", False),
    )


def _parameters(data: Mapping[str, Any]) -> dict[str, Parameter]:
    return {name: Parameter(**{**facts, "choices": tuple(facts.get("choices", ()))}) for name, facts in data.items()}


def text_of(catalogue: Catalogue) -> str:
    """Return the text of a catalogue's file. Values that are the same as the default of their field are left out."""
    data = {
        "distribution": catalogue.distribution,
        "sources": {name: dataclasses.asdict(source) for name, source in catalogue.sources.items()},
        "packages": {name: _short(facts, _NOT_STORED) for name, facts in catalogue.packages.items()},
        "classes": {name: _short(facts, _NOT_STORED, optional=True) for name, facts in catalogue.classes.items()},
        "plugins": {name: _short(plugin) for name, plugin in catalogue.plugins.items()},
        "sets": {name: _short(facts) for name, facts in catalogue.sets.items()},
    }
    return _text(data, 0) + "\n"


def _short(value: Any, without: tuple[str, ...] = (), optional: bool = False) -> Any:
    if dataclasses.is_dataclass(value):
        is_fact = optional or not isinstance(value, Package | ParameterSet)
        pairs = ((field.name, getattr(value, field.name)) for field in dataclasses.fields(value))
        return {
            name: _short(entry)
            for name, entry in pairs
            if name not in without
            and (
                not is_fact or entry not in ("", None, (), {}) or ((name == "default" and entry == "") and entry != "")
            )
            and not (entry is False and name in ("is_type", "has_open_topics", "is_partial"))
        } | ({"default": ""} if isinstance(value, Parameter) and value.default == "" else {})
    if isinstance(value, Mapping):
        return {name: _short(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_short(entry) for entry in value]
    return value


def _text(value: Any, depth: int) -> str:
    """Return JSON with one line for each object that holds no other object."""
    is_leaf = not isinstance(value, dict | list) or not any(
        isinstance(entry, dict | list) and entry for entry in (value.values() if isinstance(value, dict) else value)
    )
    flat = json.dumps(value, ensure_ascii=False)
    if (is_leaf and len(flat) < 400) or not value:
        return flat
    indent, end = " " * (depth + 1), " " * depth
    if isinstance(value, dict):
        inner = [
            f"{indent}{json.dumps(name, ensure_ascii=False)}: {_text(entry, depth + 1)}"
            for name, entry in value.items()
        ]
        return "{\n" + ",\n".join(inner) + f"\n{end}}}"
    return "[\n" + ",\n".join(f"{indent}{_text(entry, depth + 1)}" for entry in value) + f"\n{end}]"
