"""The scalars of a YAML file as values; what looks like one thing and is another to YAML is a finding."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from roverlink.generator.diagnostics import Diagnostic, Span, nearest
from roverlink.generator.table.parts import Form
from roverlink.generator.table.reading_rules import BAD_VALUE, SURPRISING_SCALAR, WRONG_TYPE
from roverlink.generator.table.value_types import (
    AnyOf,
    Boolean,
    Duration,
    Integer,
    ListOf,
    Named,
    Number,
    Scalar,
    Text,
    Type,
)

_LONGEST_INTEGER = 20  # digits; Python refuses to read thousands of them
_LONGEST_NUMBER = 40
_LARGEST_EXPONENT = 400
_NUMBER = re.compile(
    r"[-+]?((0|[1-9][0-9]*)(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]+)?" r"|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)"
)


_NULL = "tag:yaml.org,2002:null"
_KINDS: dict[type, str] = {
    Text: "a string",
    Integer: "a number",
    Number: "a number",
    Boolean: "true or false",
    Duration: "a time",
    Scalar: "a number, a text, true or false",
}


def kind_of(type: Type) -> str:
    """What a type is called where something else stands in its place."""
    if isinstance(type, Named):
        type = type.definition()
    if isinstance(type, AnyOf):
        *others, last = dict.fromkeys(kind_of(form) for form in type.forms)
        return f"{', '.join(others)} or {last}" if others else last
    for simple, name in _KINDS.items():
        if isinstance(type, simple):
            return name
    return "a list" if isinstance(type, ListOf) else "a mapping"


def fitting_form(node: Node, type: AnyOf) -> Type:
    """The form that a value has, by its kind; where it has none, the one that it looks like most."""
    by_kind = {kind_of(form): form for form in type.forms}
    kind = "a mapping" if isinstance(node, MappingNode) else "a list" if isinstance(node, SequenceNode) else "a string"
    if isinstance(node, ScalarNode) and not node.style:
        kind = "a number" if _NUMBER.fullmatch(node.value) else kind
        kind = "true or false" if node.value in ("true", "false") else kind
    return by_kind.get(kind) or by_kind.get("a string") or type.forms[0]


def _exponent(text: str) -> int:
    return int(text.lower().partition("e")[2] or 0) if text[-1].isdigit() else 0


@dataclass(slots=True)
class ScalarReader:
    """Reads scalars, and collects what does not fit."""

    file: str
    findings: list[Diagnostic]

    def span(self, node: Node) -> Span:
        """Where a node starts."""
        return Span(self.file, node.start_mark.line + 1, node.start_mark.column + 1)

    def wrong(self, node: Node, what: str, wanted: str) -> None:
        """Report a value of another kind."""
        kinds: dict[type[Node], str] = {MappingNode: "a mapping", SequenceNode: "a list"}
        found = kinds.get(type(node), "")
        found = found or (f"{node.value!r}" if node.value else "nothing")
        self.findings.append(WRONG_TYPE.at(self.span(node), f"{what} is {found}; it must be {wanted}"))

    def scalar(self, node: Node, type: Type, what: str) -> Form | None:
        """The form of a scalar, or None where it is not of the type."""
        if not isinstance(node, ScalarNode):
            self.wrong(node, what, kind_of(type))
            return None
        if isinstance(type, Integer):
            value: Any = self._integer(node, type, what)
        elif isinstance(type, Boolean):
            value = self._boolean(node, what)
        elif isinstance(type, Number):
            value = self._number(node, what)
        elif isinstance(type, Duration):
            value = self._duration(node, type, what)
        elif isinstance(type, Scalar):
            value = self._as_written(node, what)
        else:
            value = self._text(node, type if isinstance(type, Text) else Text(), what)
        return None if value is None else Form(self.span(node), value)

    def _integer(self, node: ScalarNode, type: Integer, what: str) -> int | None:
        if node.style or not re.fullmatch(r"-?(0|[1-9][0-9]*)", node.value):
            if not node.style and re.fullmatch(r"[-+0-9][-+0-9_xXobBa-fA-F:.]*", node.value):
                message = f"{what} is {node.value}, which YAML does not read as a decimal number"
                help = "write it in decimal, without leading zeros"
                self.findings.append(SURPRISING_SCALAR.at(self.span(node), message, help))
            else:
                self.wrong(node, what, "a number")
            return None
        if len(node.value) > _LONGEST_INTEGER or not type.minimum <= int(node.value) <= type.maximum:
            allowed = f"from {type.minimum} to {type.maximum}" if type.minimum < type.maximum else str(type.minimum)
            shown = node.value if len(node.value) <= _LONGEST_INTEGER else f"{node.value[:_LONGEST_INTEGER]}..."
            self.findings.append(BAD_VALUE.at(self.span(node), f"{what} is {shown}; it must be {allowed}"))
            return None
        return int(node.value)

    def _number(self, node: ScalarNode, what: str) -> Fraction | float | None:
        """An exact number, or one of the floats that are none."""
        if node.style or not _NUMBER.fullmatch(node.value):
            self.wrong(node, what, "a number")
            return None
        if len(node.value) > _LONGEST_NUMBER or abs(_exponent(node.value)) > _LARGEST_EXPONENT:
            self.findings.append(BAD_VALUE.at(self.span(node), f"{what} is {node.value[:20]}..., which no float holds"))
            return None
        text = node.value.lower().replace(".inf", "inf").replace(".nan", "nan")
        return float(text) if text[-1] in "fn" else Fraction(text)

    def _boolean(self, node: ScalarNode, what: str) -> bool | None:
        if node.value not in ("true", "false") or node.style:
            self.wrong(node, what, "true or false")
            return None
        return bool(node.value == "true")

    def _duration(self, node: ScalarNode, type: Duration, what: str) -> int | None:
        milliseconds = type.read(node.value)
        if milliseconds is None:
            message = f"{what} is {node.value!r}; it must be from {type.minimum} ms to {type.maximum // 1000} s"
            help = "a whole number and its unit, such as 500ms or 2s"
            self.findings.append(BAD_VALUE.at(self.span(node), message, help))
        return milliseconds

    def _as_written(self, node: ScalarNode, what: str) -> str | None:
        if node.tag == _NULL:
            self.wrong(node, what, kind_of(Scalar()))
            return None
        return str(node.value)

    def _text(self, node: ScalarNode, type: Text, what: str) -> str | None:
        if node.tag == _NULL:
            self.wrong(node, what, "a string")
            return None
        if node.tag != "tag:yaml.org,2002:str":
            kinds = {"bool": "true or false", "int": "a number", "float": "a number", "timestamp": "a time"}
            kind = kinds.get(node.tag[18:], node.tag[18:])
            message = f"{what} is {node.value}, which YAML reads as {kind}, not as a string"
            self.findings.append(SURPRISING_SCALAR.at(self.span(node), message, f'quote it: "{node.value}"'))
            return None
        return self._checked_text(node, type, what)

    def _checked_text(self, node: ScalarNode, type: Text, what: str) -> str | None:
        value: str = node.value
        if type.choices and value not in type.choices:
            help = nearest(value, type.choices)
            message = f"{what} is {value!r}; it must be one of {', '.join(type.choices)}"
            self.findings.append(BAD_VALUE.at(self.span(node), message, help))
            return None
        message, help = type.fault(value) if type.fault else ("", "")
        if message:
            self.findings.append(BAD_VALUE.at(self.span(node), f"{what} is {value!r}, {message}", help))
            return None
        if not value or (type.pattern and not type.checked_by_rule and not re.fullmatch(type.pattern, value)):
            self.bad(node, value, what, type)
            return None
        return value

    def bad(self, node: Node, value: str, what: str, type: Text) -> None:
        """Report a text that does not fit its pattern."""
        help = f"for example {type.example}" if type.example else ""
        message = f"{what} is {value!r}, which cannot stand there" if value else f"{what} is empty"
        self.findings.append(BAD_VALUE.at(self.span(node), message, help))
