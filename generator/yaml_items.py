"""A YAML file along a format: its values with their places, and every mistake in it as a finding.

`yaml.compose` keeps line and column. What does not fit is reported and left out; what is around it is still read.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from generator.findings import Finding, FindingsError, Rule, Severity, Span, nearest
from generator.table_format import Boolean, Duration, Integer, Leaf, ListOf, MapOf, Network, Object, Scalar, Text, Type

UNREADABLE = Rule("MAP101", "unreadable-table", Severity.FATAL)
SYNTAX = Rule("MAP102", "yaml-syntax")
DUPLICATE_KEY = Rule("MAP103", "duplicate-key")
UNKNOWN_KEY = Rule("MAP104", "unknown-key")
MISSING_KEY = Rule("MAP105", "missing-key")
WRONG_TYPE = Rule("MAP106", "wrong-type")
SURPRISING_SCALAR = Rule("MAP107", "surprising-scalar")
BAD_VALUE = Rule("MAP108", "bad-value")

_LONGEST_INTEGER = 20  # digits; Python refuses to read thousands of them
_NULL = "tag:yaml.org,2002:null"
_WANTED = {
    Text: "a string",
    Integer: "a number",
    Boolean: "true or false",
    Duration: "a time",
    Network: "an address or a network",
    Scalar: "a number, a text, true or false",
}


@dataclass(slots=True)
class Item:
    """A value of the file with its place; the values below it are items too."""

    value: Any
    span: Span
    entries: dict[str, Item] = field(default_factory=dict)
    items: list[Item] = field(default_factory=list)

    def has(self, *keys: str) -> bool:
        """Whether every one of the entries is there."""
        return all(key in self.entries for key in keys)

    def entry(self, key: str) -> Item:
        """An entry that is a mapping or a list; an empty one at this item's place where it is not there."""
        return self.entries.get(key) or Item(None, self.span)

    def get(self, key: str, default: Any = None) -> Any:
        """The value of an entry."""
        return self.entries[key].value if key in self.entries else default

    def texts(self, key: str) -> tuple[str, ...]:
        """The items of an entry that is a list."""
        return tuple(item.value for item in self.entries[key].items) if key in self.entries else ()

    def spans(self) -> Mapping[str, Span]:
        """The place of each key's value, and of each entry or item two levels down as ``key.entry``."""
        spans = {key: item.span for key, item in self.entries.items()}
        for key, item in self.entries.items():
            spans |= {f"{key}.{name}": entry.span for name, entry in item.entries.items()}
            spans |= {f"{key}.{below.value}": below.span for below in item.items}
        return spans


def read_item(text: str, file: str, type: Type, what: str, findings: list[Finding]) -> Item | None:
    """The text of a file as an item, as far as it fits the format; what does not is added to the findings.

    ``file`` and ``what`` are how findings call the file and its whole. None where the whole is of another type.
    Raises `FindingsError` where the text is not YAML.
    """
    return _Reader(file, findings).value(_compose(text, file), type, what)


def read_text(path: Path, file: str) -> str:
    """The text of the file. Raises `FindingsError` where it cannot be read."""
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        help = "give the table with --table, or run this in the folder that holds mapping.yaml"
        raise FindingsError([UNREADABLE.at(Span(file), f"cannot be read: {error.strerror}", help)]) from error
    except UnicodeDecodeError as error:
        raise FindingsError([UNREADABLE.at(Span(file), f"is not UTF-8: {error}")]) from error


def _compose(text: str, file: str) -> Node:
    try:
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        span = Span(file, mark.line + 1, mark.column + 1) if mark else Span(file)
        raise FindingsError([SYNTAX.at(span, f"not YAML: {error.problem or error.context}")]) from error
    except yaml.reader.ReaderError as error:
        before = text[: error.position]
        span = Span(file, before.count("\n") + 1, len(before) - before.rfind("\n"))
        raise FindingsError(
            [SYNTAX.at(span, f"not YAML: it cannot hold the character {error.character:#x}")]
        ) from error
    except RecursionError as error:
        raise FindingsError([SYNTAX.at(Span(file), "nested too deeply")]) from error
    if root is None:
        raise FindingsError([UNREADABLE.at(Span(file), "the file is empty", "see docs/adding-a-message.md")])
    return root


@dataclass(slots=True)
class _Reader:
    """Walks the YAML tree along the format, and collects what does not fit."""

    file: str
    findings: list[Finding]

    def value(self, node: Node, type: Type, what: str) -> Item | None:
        """The item of a node, or None where it is not of the type."""
        if isinstance(type, Object):
            return self._object(node, type, what)
        if isinstance(type, MapOf):
            return self._map(node, type, what)
        if isinstance(type, ListOf):
            return self._list(node, type, what)
        return self._scalar(node, type, what)

    def _span(self, node: Node) -> Span:
        return Span(self.file, node.start_mark.line + 1, node.start_mark.column + 1)

    def _wrong(self, node: Node, what: str, wanted: str) -> None:
        kinds: dict[type[Node], str] = {MappingNode: "a mapping", SequenceNode: "a list"}
        found = kinds.get(type(node), "")
        found = found or (f"{node.value!r}" if node.value else "nothing")
        self.findings.append(WRONG_TYPE.at(self._span(node), f"{what} is {found}; it must be {wanted}"))

    def _object(self, node: Node, type: Object, what: str) -> Item | None:
        if not isinstance(node, MappingNode):
            self._wrong(node, what, "a mapping")
            return None
        item = Item(None, self._span(node))
        present: set[str] = set()
        for name, key_node, value_node in self._entries(node, what):
            present.add(name)
            if name not in type.keys:
                help = nearest(name, type.keys, f"known here: {', '.join(type.keys)}")
                self.findings.append(UNKNOWN_KEY.at(self._span(key_node), f"{what} has no key {name!r}", help))
            elif (value := self.value(value_node, type.keys[name].type, name)) is not None:
                item.entries[name] = value
        for name, key in type.keys.items():
            if key.required and name not in present:
                finding = MISSING_KEY.at(item.span, f"{what} lacks the key {name!r}", f"{name}: {key.meaning}")
                self.findings.append(finding)
        return item

    def _map(self, node: Node, type: MapOf, what: str) -> Item | None:
        if not isinstance(node, MappingNode):
            self._wrong(node, what, "a mapping")
            return None
        item = Item(None, self._span(node))
        for name, key_node, value_node in self._entries(node, what):
            if type.key.pattern and not re.fullmatch(type.key.pattern, name):
                self._bad(key_node, name, f"a key of {what}", type.key)
            elif (value := self.value(value_node, type.value, f"{what}.{name}")) is not None:
                item.entries[name] = value
        return item

    def _entries(self, node: MappingNode, what: str) -> Iterator[tuple[str, Node, Node]]:
        first: dict[str, Span] = {}
        for key_node, value_node in node.value:
            span = self._span(key_node)
            if not isinstance(key_node, ScalarNode):
                self.findings.append(WRONG_TYPE.at(span, f"a key of {what} is no name"))
                continue
            name = key_node.value
            if name in first:
                also = [(first[name], "first here")]
                self.findings.append(
                    DUPLICATE_KEY.at(span, f"{what} has the key {name!r} twice", "keep one of them", also)
                )
                continue
            first[name] = span
            yield name, key_node, value_node

    def _list(self, node: Node, type: ListOf, what: str) -> Item | None:
        if not isinstance(node, SequenceNode):
            self._wrong(node, what, "a list")
            return None
        singular = {"messages": "a row of messages", "retired": "a row of retired"}.get(what, f"an item of {what}")
        items = [self.value(child, type.item, singular) for child in node.value]
        if len(items) < type.least:
            self.findings.append(BAD_VALUE.at(self._span(node), f"{what} is empty"))
        item = Item(None, self._span(node), items=[item for item in items if item is not None])
        if isinstance(type.item, (Text, Network)):
            self._check_unique(item, what)
        return item

    def _check_unique(self, texts: Item, what: str) -> None:
        first: dict[str, Span] = {}
        for item in texts.items:
            if (before := first.setdefault(item.value, item.span)) is not item.span:
                message = f"{what} holds {item.value!r} twice"
                self.findings.append(BAD_VALUE.at(item.span, message, "keep one of them", [(before, "first here")]))

    def _scalar(self, node: Node, type: Leaf, what: str) -> Item | None:
        if not isinstance(node, ScalarNode):
            self._wrong(node, what, _WANTED[type.__class__])
            return None
        if isinstance(type, Integer):
            value: Any = self._integer(node, type, what)
        elif isinstance(type, Boolean):
            value = self._boolean(node, what)
        elif isinstance(type, Duration):
            value = self._duration(node, type, what)
        elif isinstance(type, Network):
            value = self._network(node, type, what)
        elif isinstance(type, Scalar):
            value = None if node.tag == _NULL else node.value
            if value is None:
                self._wrong(node, what, _WANTED[Scalar])
        else:
            value = self._text(node, type, what)
        return None if value is None else Item(value, self._span(node))

    def _integer(self, node: ScalarNode, type: Integer, what: str) -> int | None:
        if node.style or not re.fullmatch(r"-?(0|[1-9][0-9]*)", node.value):
            if not node.style and re.fullmatch(r"[-+0-9][-+0-9_xXobBa-fA-F:.]*", node.value):
                message = f"{what} is {node.value}, which YAML does not read as a decimal number"
                help = "write it in decimal, without leading zeros"
                self.findings.append(SURPRISING_SCALAR.at(self._span(node), message, help))
            else:
                self._wrong(node, what, "a number")
            return None
        if len(node.value) > _LONGEST_INTEGER or not type.minimum <= int(node.value) <= type.maximum:
            allowed = f"from {type.minimum} to {type.maximum}" if type.minimum < type.maximum else str(type.minimum)
            shown = node.value if len(node.value) <= _LONGEST_INTEGER else f"{node.value[:_LONGEST_INTEGER]}..."
            self.findings.append(BAD_VALUE.at(self._span(node), f"{what} is {shown}; it must be {allowed}"))
            return None
        return int(node.value)

    def _boolean(self, node: ScalarNode, what: str) -> bool | None:
        if node.value not in ("true", "false") or node.style:
            self._wrong(node, what, "true or false")
            return None
        return bool(node.value == "true")

    def _duration(self, node: ScalarNode, type: Duration, what: str) -> int | None:
        milliseconds = type.read(node.value)
        if milliseconds is None:
            message = f"{what} is {node.value!r}; it must be from {type.minimum} ms to {type.maximum // 1000} s"
            help = "a whole number and its unit, such as 500ms or 2s"
            self.findings.append(BAD_VALUE.at(self._span(node), message, help))
        return milliseconds

    def _network(self, node: ScalarNode, type: Network, what: str) -> str | None:
        if fault := type.fault(node.value):
            message = f"{what} is {node.value!r}, which is no address and no network"
            self.findings.append(BAD_VALUE.at(self._span(node), message, fault))
            return None
        return str(node.value)

    def _text(self, node: ScalarNode, type: Text, what: str) -> str | None:
        if node.tag == _NULL:
            self._wrong(node, what, "a string")
            return None
        if node.tag != "tag:yaml.org,2002:str":
            kinds = {"bool": "true or false", "int": "a number", "float": "a number", "timestamp": "a time"}
            kind = kinds.get(node.tag[18:], node.tag[18:])
            message = f"{what} is {node.value}, which YAML reads as {kind}, not as a string"
            self.findings.append(SURPRISING_SCALAR.at(self._span(node), message, f'quote it: "{node.value}"'))
            return None
        return self._checked_text(node, type, what)

    def _checked_text(self, node: ScalarNode, type: Text, what: str) -> str | None:
        value: str = node.value
        if type.choices and value not in type.choices:
            help = nearest(value, type.choices)
            message = f"{what} is {value!r}; it must be one of {', '.join(type.choices)}"
            self.findings.append(BAD_VALUE.at(self._span(node), message, help))
            return None
        if not value or (type.pattern and not re.fullmatch(type.pattern, value)):
            self._bad(node, value, what, type)
            return None
        return value

    def _bad(self, node: Node, value: str, what: str, type: Text) -> None:
        help = f"for example {type.example}" if type.example else ""
        message = f"{what} is {value!r}, which cannot stand there" if value else f"{what} is empty"
        self.findings.append(BAD_VALUE.at(self._span(node), message, help))
