"""Descriptions of launch files in the catalogue: what a launch file of a package starts, without its source.

A description is a list of actions as JSON values: the name of the action, its fields, and its texts as
`substitutions.stored_text` makes them. Of actions that come from a function (OpaqueFunction), a description says only
that there are some; the arguments of such a launch file are known.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from check_launch.expansion import actions as of_launch
from check_launch.expansion.actions import Action, GivenFile, GivenParameter, Remapping, StartNode
from check_launch.expansion.substitutions import from_stored, stored_text
from roverlink.generator.diagnostics import Span

_ACTIONS: Mapping[str, type[Action]] = {
    member.__name__: member
    for member in vars(of_launch).values()
    if isinstance(member, type) and issubclass(member, Action)
}
_LEFT_OUT = ("place", "target_place", "description")


def stored_actions(actions: list[Action]) -> list[Any]:
    """Return actions as JSON values. Raises `NotImplementedError` if one of them cannot be stored."""
    return [_stored(action) for action in actions]


def _stored(value: Any) -> Any:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        pairs = (
            (field.name, getattr(value, field.name))
            for field in dataclasses.fields(value)
            if field.name not in _LEFT_OUT and not callable(getattr(value, field.name))
        )
        kept = {name: _stored(part) for name, part in pairs if part not in (None, "", [], (), {})}
        if isinstance(value, GivenParameter) and isinstance(value.value, list) and len(value.value) == 1:
            kept["value"] = {"list": list(map(_stored, value.value))}  # as a text, it would be the same as its one part
        return {"is": type(value).__name__, **kept}
    if isinstance(value, Mapping):
        return {"map": [[stored_text(name), _stored(part)] for name, part in value.items()]}
    if isinstance(value, list | tuple) and any(
        dataclasses.is_dataclass(part) or isinstance(part, tuple) for part in value
    ):
        return {"list": [_stored(part) for part in value if not isinstance(part, Span)]}
    return stored_text(value)


def actions_of_stored(stored: list[Any], place: Span) -> list[Action]:
    """Return the actions of a description; ``place`` is that of the action that includes them."""
    return [_read(entry, place) for entry in stored]


def _read(value: Any, place: Span) -> Any:
    if isinstance(value, dict):
        if "is" in value:
            return _object(value, place)
        if "map" in value:
            return {_hashable(from_stored(name)): _read(part, place) for name, part in value["map"]}
        if "list" in value:
            return [_read(part, place) for part in value["list"]]
    if isinstance(value, list):
        return [_read(part, place) for part in value]
    return from_stored(value)


def _hashable(name: Any) -> Any:
    return tuple(name) if isinstance(name, list) else name


def _object(value: dict[str, Any], place: Span) -> Any:
    fields = {name: _read(part, place) for name, part in value.items() if name != "is"}
    kind = value["is"]
    if kind == "Remapping":
        return Remapping(fields.get("source", ""), fields.get("target", ""), place, place)
    if kind == "GivenParameter":
        return GivenParameter(fields.get("name", ""), fields.get("value", ""), place, fields.get("is_text", False))
    if kind == "GivenFile":
        return GivenFile(
            fields.get("path", ""),
            place,
            fields.get("has_substitutions", False),
            fields.get("root_key", ""),
            fields.get("rewrites", {}),
        )
    if kind == "Include":
        fields["arguments"] = [(name, text, place) for name, text in fields.get("arguments", [])]
    if condition := fields.pop("condition", None):
        fields["condition"] = (bool(condition[0]), condition[1])
    if kind == "StartNode":
        return StartNode(place, **fields)
    return _ACTIONS[kind](place, **fields)
