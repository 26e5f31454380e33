"""Reader of a YAML file whose expected content is described by a type. It returns the values with their places.

`yaml.compose` is used instead of `yaml.load`, because its nodes keep line and column. A value with a mistake is
reported and left out; the values around it are still read.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from roverlink.bounded_yaml import BoundedLoader
from roverlink.generator import source_files
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span
from roverlink.generator.table.parts import Form
from roverlink.generator.table.reading_rules import (
    BadValue,
    DuplicateKey,
    MissingKey,
    UnknownKey,
    UnreadableTable,
    WrongType,
    YamlSyntax,
)
from roverlink.generator.table.value_types import AnyOf, ListOf, MapOf, Named, Object, Text, Type
from roverlink.generator.table.yaml_scalars import ScalarReader, fitting_form
from roverlink.suggestions import nearest

_LISTS_OF_ROWS = ("`messages`", "`retired`")


def read_form(text: str, file: str, type: Type, subject: str, findings: list[Diagnostic]) -> Form | None:
    """Parse a YAML text and return its value. Parts that do not fit the type are left out and reported.

    ``file`` and ``subject`` are the names of the file and of its top-level value in diagnostics. Returns None if the
    top-level value does not fit the type. Raises `DiagnosticsError` if the text is not YAML.
    """
    return _Reader(file, findings).value(_compose(text, file), type, subject)


def read_text(path: Path, file: str) -> str:
    """Return the text of a file; ``file`` is its name in diagnostics.

    Raises `DiagnosticsError` if it cannot be read.
    """
    try:
        return source_files.read_text(path.parent, path.name)
    except OSError as error:
        help = (
            "give the table with --table, run this in a project, or start one with `roverlink init`; "
            "`roverlink lint PROTO_ROOT` checks .proto files without a table"
        )
        raise DiagnosticsError(
            [UnreadableTable.at(Span(file), f"the table cannot be read: {error.strerror}", help)]
        ) from error
    except UnicodeDecodeError as error:
        raise DiagnosticsError(
            [UnreadableTable.at(Span(file), f"the table is not UTF-8: {error}", "save the file in UTF-8")]
        ) from error


def _compose(text: str, file: str) -> Node:
    try:
        root = yaml.compose(text, Loader=BoundedLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        span = Span(file, mark.line + 1, mark.column + 1) if mark else Span(file)
        message = f"cannot parse the YAML: {error.problem or error.context}"
        help = "correct this line or the line above it, such as a missing bracket or a wrong indentation"
        raise DiagnosticsError([YamlSyntax.at(span, message, help)]) from error
    except yaml.reader.ReaderError as error:
        before = text[: error.position]
        span = Span(file, before.count("\n") + 1, len(before) - before.rfind("\n"))
        raise DiagnosticsError(
            [YamlSyntax.at(span, f"cannot parse the YAML: the character {error.character:#x} is not allowed")]
        ) from error
    if root is None:
        raise DiagnosticsError(
            [UnreadableTable.at(Span(file), "the file is empty", "docs/adding-a-message.md shows an example")]
        )
    return root


@dataclass(slots=True)
class _Reader(ScalarReader):
    """Reader of YAML nodes whose expected content is described by a type. It adds a diagnostic for each mistake."""

    def value(self, node: Node, type: Type, subject: str) -> Form | None:
        """Return the value of a YAML node. If the node does not fit the type, report it and return None.

        ``subject`` is the value's name in diagnostics, such as "`topic`" or "a row of `messages`".
        """
        if isinstance(type, Named):
            type = type.definition()
        if isinstance(type, AnyOf):
            type = fitting_form(node, type)
        if isinstance(type, Object):
            return self._object(node, type, subject)
        if isinstance(type, MapOf):
            return self._map(node, type, subject)
        if isinstance(type, ListOf):
            return self._list(node, type, subject)
        return self.scalar(node, type, subject)

    def _object(self, node: Node, type: Object, subject: str) -> Form | None:
        if not isinstance(node, MappingNode):
            self.wrong(node, subject, "a mapping")
            return None
        span, entries = self.span(node), dict[str, Form]()
        present: set[str] = set()
        unknown: dict[str, Span] = {}
        for name, key_node, value_node in self._entries(node, subject):
            present.add(name)
            if name not in type.keys and type.others and re.fullmatch(type.others.key.pattern, name):
                if (value := self.value(value_node, type.others.value, _within(subject, name))) is not None:
                    entries[name] = value
            elif name not in type.keys:
                unknown[name] = self.span(key_node)
                help = nearest(name, type.keys, f"known here: {', '.join(type.keys)}")
                self.findings.append(UnknownKey.at(unknown[name], f"unknown key {name!r} in {subject}", help))
            elif (value := self.value(value_node, type.keys[name].type, f"`{name}`")) is not None:
                entries[name] = value
        for name, key in type.keys.items():
            if key.required and name not in present:
                misspelt = [
                    span for other, span in unknown.items() if nearest(other, type.keys, "") == nearest(name, [name])
                ]
                message, help = f"{subject} lacks the key {name!r}", f"{name}: {key.meaning.text}"
                self.findings.append(MissingKey.at(span, message, help, rests_on=misspelt))
        return Form(span, entries=entries)

    def _map(self, node: Node, type: MapOf, subject: str) -> Form | None:
        if not isinstance(node, MappingNode):
            self.wrong(node, subject, "a mapping")
            return None
        entries = dict[str, Form]()
        for name, key_node, value_node in self._entries(node, subject):
            if type.key.pattern and not re.fullmatch(type.key.pattern, name):
                self.bad(key_node, name, f"a key of {subject}", type.key)
            elif (value := self.value(value_node, type.value, _within(subject, name))) is not None:
                entries[name] = value
        return Form(self.span(node), entries=entries)

    def _entries(self, node: MappingNode, subject: str) -> Iterator[tuple[str, Node, Node]]:
        first: dict[str, Span] = {}
        for key_node, value_node in node.value:
            span = self.span(key_node)
            if not isinstance(key_node, ScalarNode):
                self.findings.append(WrongType.at(span, f"a key of {subject} is not a name"))
                continue
            name = key_node.value
            if name in first:
                also = [(first[name], "first here")]
                self.findings.append(
                    DuplicateKey.at(span, f"{subject} has the key {name!r} twice", "keep one of the two", also)
                )
                continue
            first[name] = span
            yield name, key_node, value_node

    def _list(self, node: Node, type: ListOf, subject: str) -> Form | None:
        if not isinstance(node, SequenceNode):
            self.wrong(node, subject, "a list")
            return None
        singular = f"{'a row' if subject in _LISTS_OF_ROWS else 'an item'} of {subject}"
        items = [self.value(child, type.item, singular) for child in node.value]
        if len(items) < type.least:
            self.findings.append(BadValue.at(self.span(node), f"{subject} is an empty list", "add an item"))
        form = Form(self.span(node), items=tuple(item for item in items if item is not None))
        if isinstance(type.item, Text) and type.unique:
            self._check_unique(form, subject)
        return form

    def _check_unique(self, texts: Form, subject: str) -> None:
        first: dict[Any, Span] = {}
        for item in texts.items or ():
            if (before := first.setdefault(item.value, item.span)) is not item.span:
                message = f"{subject} contains {item.value!r} twice"
                self.findings.append(BadValue.at(item.span, message, "keep one of the two", [(before, "first here")]))


def _within(subject: str, name: str) -> str:
    """Return the name of an inner key in diagnostics: the key ``x`` in "`fields`" is "`fields.x`"."""
    return f"`{subject.strip('`')}.{name}`"
