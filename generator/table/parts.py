"""Base class of the parts of mapping.yaml. A part is a dataclass whose annotations declare the keys of a mapping.

An attribute is a key of the table if its annotation includes a `Meaning`. The other properties of the key are:

- The type of its value is the `Type` in the annotation. Without one, it follows from the Python type (``bool``,
  ``str``, ``Literal[...]``, another part, or a tuple or mapping of these).
- The key is required if the attribute has no default.

``NAME`` marks the attribute that holds the name of a part, for parts that stand by name in a mapping. ``NOT_EMPTY``
marks a list that must have at least one item.
"""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, field
from enum import Enum
from fractions import Fraction
from functools import cache
from types import UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from roverlink.generator.diagnostics import Span
from roverlink.generator.table.value_types import AnyOf, Boolean, Key, ListOf, MapOf, Meaning, Named, Object, Text, Type


class Mark(Enum):
    """Mark in the annotation of an attribute: `NAME` or `NOT_EMPTY`, which the module explains."""

    NAME = "name"
    NOT_EMPTY = "not empty"


_NOWHERE = Span("")
NAME = Mark.NAME
NOT_EMPTY = Mark.NOT_EMPTY


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """Base class of the parts of mapping.yaml, such as a row. A part knows the place of each of its values."""

    span: Span = _NOWHERE
    """Place at which the part starts in the file."""
    spans: Mapping[str, Span] = field(default_factory=dict, repr=False)
    """Place of each key's value, by the key: ``topic``.

    If the value is a mapping or a list of texts, the places of its entries are here too: ``fields.x``.
    """

    def at(self, key: str) -> Span:
        """Return the place of a key's value. If the key is missing, return the place of the whole part."""
        return self.spans.get(key, self.span)


@dataclass(frozen=True, slots=True)
class Form:
    """Value in a YAML file with its place: a scalar, a list or a mapping. Only the attribute for this kind is set."""

    span: Span
    value: bool | str | int | Fraction | float | None = None
    """Value of a scalar, such as a number; None for a list or a mapping."""
    items: tuple[Form, ...] | None = None
    """Items of a list; None for a scalar or a mapping."""
    entries: Mapping[str, Form] | None = field(default=None, hash=False)
    """Entries of a mapping by key; None for a scalar or a list."""

    def spans(self) -> dict[str, Span]:
        """Return the place of each entry of a mapping, by its key, and the places one level deeper as ``key.entry``.

        For ``{fields: {x: a}, ignore: [b]}`` the keys are ``fields``, ``fields.x``, ``ignore`` and ``ignore.b``.
        """
        spans = {}
        for key, form in (self.entries or {}).items():
            spans[key] = form.span
            spans |= {f"{key}.{name}": entry.span for name, entry in (form.entries or {}).items()}
            spans |= {f"{key}.{item.value}": item.span for item in form.items or () if item.value is not None}
        return spans


P = TypeVar("P", bound=Part)


@cache
def object_of(part: type[Any]) -> Object:
    """Return the YAML type for a part's class: a mapping with the keys that its attributes declare.

    Required keys come before optional ones. In both groups, keys of the class itself come before inherited keys.
    """
    # The annotations are texts (`from __future__ import annotations`); include_extras keeps what Annotated adds to a
    # type.
    annotations = get_type_hints(part, include_extras=True)
    fields = {field.name: field for field in dataclasses.fields(part)}
    names = dict.fromkeys(name for base in part.__mro__ for name in inspect.get_annotations(base) if name in fields)
    keys = {}
    for name in names:
        if meaning := next((note for note in _notes(annotations[name]) if isinstance(note, Meaning)), None):
            keys[meaning.key or name] = _key(_type_of(annotations[name]), meaning, fields[name])
    return Object(dict(sorted(keys.items(), key=lambda item: not item[1].required)), part=part)


def _key(type: Type, meaning: Meaning, field: Field[Any]) -> Key:
    if field.default_factory is not MISSING:
        return Key(type, meaning, default=field.default_factory(), attribute=field.name)
    if field.default is not MISSING:
        return Key(type, meaning, default=field.default, attribute=field.name)
    return Key(type, meaning, required=True, attribute=field.name)


def _notes(annotation: Any) -> list[Any]:
    return list(get_args(annotation)[1:]) if get_origin(annotation) is Annotated else []


def _type_of(annotation: Any) -> Type:
    """Return the type of the YAML value for an attribute with this annotation.

    For example, ``bool`` gives `Boolean`, and ``tuple[Row, ...]`` gives a `ListOf` mappings.
    """
    notes = _notes(annotation)
    for note in notes:
        if isinstance(note, Type):
            return note
    python = get_args(annotation)[0] if notes else annotation
    origin, inner = get_origin(python), get_args(python)
    if origin in (Union, UnionType):
        return _type_of(next(part for part in inner if part is not type(None)))
    if origin is Literal:
        return Text(choices=inner)
    if origin is tuple:
        item = _type_of(inner[0])
        named = _map_of_named(item)
        return named or ListOf(item, least=1 if NOT_EMPTY in notes else 0)
    if origin is not None and issubclass(origin, Mapping):
        key = _type_of(inner[0])
        return MapOf(key if isinstance(key, Text) else Text(), _type_of(inner[1]))
    if issubclass(python, Part):
        return object_of(python)
    simple: dict[Any, Type] = {bool: Boolean(), str: Text()}
    return simple[python]


def _map_of_named(type: Type) -> MapOf | None:
    """Return the type of a YAML mapping from names to parts, if ``type`` is such a part; None otherwise.

    A part stands by name in a mapping, such as ``peers: {hardware: ...}``, if one of its attributes is marked `NAME`.
    """
    if isinstance(type, Object) and type.part:
        for name, annotation in get_type_hints(type.part, include_extras=True).items():
            key = _type_of(annotation) if NAME in _notes(annotation) else None
            if isinstance(key, Text):
                return MapOf(key, type, name)
    return None


def build(part: type[P], form: Form, **further: Any) -> P:
    """Return an instance of the class ``part`` with the values that the file gives to its keys.

    ``further`` sets the attributes that are not keys. If a key is missing, its attribute gets the default, or an empty
    value if the key is required. Inner parts that lack a required key are left out of lists and mappings.
    """
    values = {}
    entries = form.entries or {}
    declared = object_of(part)  # type: ignore[arg-type]  # mypy takes a generic class for unhashable
    for name, key in declared.keys.items():
        here = entries.get(name)
        if here is not None and (key.required or _is_whole(key.type, here)):
            values[key.attribute] = _value(key.type, here)
        elif key.required or isinstance(key.default, Part):
            values[key.attribute] = _empty(key.type, form.span)
    return part(span=form.span, spans=form.spans(), **values, **further)


def _value(type: Type, form: Form) -> Any:
    if isinstance(type, Object) and type.part:
        return build(type.part, form)
    if isinstance(type, ListOf):
        return tuple(_value(type.item, item) for item in form.items or () if _is_whole(type.item, item))
    if isinstance(type, MapOf):
        kept = {name: entry for name, entry in (form.entries or {}).items() if _is_whole(type.value, entry)}
        if type.name and isinstance(type.value, Object) and type.value.part:
            part = type.value.part
            return tuple(build(part, entry, **{type.name: name}) for name, entry in kept.items())
        return {name: _value(type.value, entry) for name, entry in kept.items()}
    return form if isinstance(type, (AnyOf, Named)) else form.value


def _empty(type: Type, span: Span) -> Any:
    """Return an empty value of a type, for a required key that is missing."""
    if isinstance(type, (Object, ListOf, MapOf)):
        return _value(type, Form(span))
    return "" if isinstance(type, Text) else 0


def _is_whole(type: Type, form: Form) -> bool:
    """Return True unless the type is a part and the value lacks one of the part's required keys."""
    keys = type.keys if isinstance(type, Object) and type.part else {}
    return all(name in (form.entries or {}) for name, key in keys.items() if key.required)
