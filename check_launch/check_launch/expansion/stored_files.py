"""Descriptions of launch files in the catalogue: what a launch file of a package starts, without its source.

A description is a list of actions as JSON values: the name of the action, its fields, and its texts as
`substitutions.stored_text` makes them. Launch files whose actions come from functions (OpaqueFunction) have none.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from check_launch.expansion import actions as of_launch
from check_launch.expansion.actions import Action, GivenFile, GivenParameter, Remapping, StartNode
from check_launch.expansion.places import Place
from check_launch.expansion.substitutions import from_stored, stored_text

_ACTIONS: Mapping[str, type[Action]] = {
    one.__name__: one
    for one in vars(of_launch).values()
    if isinstance(one, type) and issubclass(one, Action) and one is not of_launch.Opaque
}
_LEFT_OUT = ("place", "target_place", "description")


def stored_actions(actions: list[Action]) -> list[Any]:
    """Return actions as JSON values. Raises `NotImplementedError` if one of them cannot be stored."""
    return [_stored(one) for one in actions]


def _stored(value: Any) -> Any:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        if isinstance(value, of_launch.Opaque):
            raise NotImplementedError("OpaqueFunction")
        pairs = ((one.name, getattr(value, one.name)) for one in dataclasses.fields(value) if one.name not in _LEFT_OUT)
        kept = {name: _stored(one) for name, one in pairs if one not in (None, "", [], (), {})}
        return {"is": type(value).__name__, **kept}
    if isinstance(value, Mapping):
        return {"map": [[stored_text(name), _stored(one)] for name, one in value.items()]}
    if isinstance(value, list | tuple) and any(
        dataclasses.is_dataclass(one) or isinstance(one, tuple) for one in value
    ):
        return {"list": [_stored(one) for one in value if not isinstance(one, Place)]}
    return stored_text(value)


def actions_of_stored(stored: list[Any], place: Place) -> list[Action]:
    """Return the actions of a description; ``place`` is that of the action that includes them."""
    return [_read(one, place) for one in stored]


def _read(value: Any, place: Place) -> Any:
    if isinstance(value, dict):
        if "is" in value:
            return _object(value, place)
        if "map" in value:
            return {_hashable(from_stored(name)): _read(one, place) for name, one in value["map"]}
        if "list" in value:
            return [_read(one, place) for one in value["list"]]
    if isinstance(value, list):
        return [_read(one, place) for one in value]
    return from_stored(value)


def _hashable(name: Any) -> Any:
    return tuple(name) if isinstance(name, list) else name


def _object(value: dict[str, Any], place: Place) -> Any:
    fields = {name: _read(one, place) for name, one in value.items() if name != "is"}
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
