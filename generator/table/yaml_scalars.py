"""Reader of YAML scalars: numbers, texts, ``true`` and ``false``.

Values that YAML reads as something other than they look like are reported.

PyYAML follows YAML 1.1, in which ``no`` and ``off`` are booleans, ``012`` is octal, ``1:30`` is a number in base 60 and
``2024-01-01`` is a date. MAP107 reports these instead of passing a surprising value on.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.table.parts import Form
from roverlink.generator.table.reading_rules import BadValue, SurprisingScalar, WrongType
from roverlink.generator.table.value_types import (
    AnyOf,
    Boolean,
    DataRate,
    Duration,
    Integer,
    ListOf,
    Named,
    Number,
    Scalar,
    Text,
    Type,
)
from roverlink.suggestions import nearest

_LONGEST_INTEGER = 20  # digits; int() raises ValueError for more than 4300 digits
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
    DataRate: "a rate of data",
    Scalar: "a number, a text, true or false",
}


def kind_of(type: Type) -> str:
    """Return the name of a type in diagnostics, such as "a list" in "it must be a list"."""
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
    """Return the alternative of ``type`` that fits a YAML node.

    If none fits, return the alternative for strings, or else the first one.
    """
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
    """Reader of YAML scalars. It adds a diagnostic to the findings for each mistake."""

    file: str
    findings: list[Diagnostic]

    def span(self, node: Node) -> Span:
        """Return the place at which a node starts."""
        return Span(self.file, node.start_mark.line + 1, node.start_mark.column + 1)

    def wrong(self, node: Node, subject: str, wanted: str) -> None:
        """Report a value of the wrong type; ``wanted`` is the right type in words, such as "a list".

        ``subject`` is the value's name in the diagnostic.
        """
        kinds: dict[type[Node], str] = {MappingNode: "a mapping", SequenceNode: "a list"}
        found = kinds.get(type(node), "")
        quoted = isinstance(node, ScalarNode) and node.style
        found = found or (f"{'the text ' if quoted else ''}{node.value!r}" if node.value else "empty")
        self.findings.append(WrongType.at(self.span(node), f"{subject} is {found}; it must be {wanted}"))

    def scalar(self, node: Node, type: Type, subject: str) -> Form | None:
        """Return the value of a YAML scalar. If it does not fit the type, report it and return None."""
        if not isinstance(node, ScalarNode):
            self.wrong(node, subject, kind_of(type))
            return None
        if isinstance(type, Integer):
            value: Any = self._integer(node, type, subject)
        elif isinstance(type, Boolean):
            value = self._boolean(node, subject)
        elif isinstance(type, Number):
            value = self._number(node, subject)
        elif isinstance(type, Duration):
            value = self._duration(node, type, subject)
        elif isinstance(type, DataRate):
            value = self._data_rate(node, type, subject)
        elif isinstance(type, Scalar):
            value = self._as_written(node, subject)
        else:
            value = self._text(node, type if isinstance(type, Text) else Text(), subject)
        return None if value is None else Form(self.span(node), value)

    def _integer(self, node: ScalarNode, type: Integer, subject: str) -> int | None:
        # A scalar with a style is quoted or a block, so YAML reads it as a string.
        if node.style or not re.fullmatch(r"-?(0|[1-9][0-9]*)", node.value):
            if not node.style and re.fullmatch(r"[-+0-9][-+0-9_xXobBa-fA-F:.]*", node.value):
                message = f"{subject} is {node.value}; YAML does not read this as a decimal number"
                help = "write it in decimal, without leading zeros"
                self.findings.append(SurprisingScalar.at(self.span(node), message, help))
            else:
                self.wrong(node, subject, "a number")
            return None
        if len(node.value) > _LONGEST_INTEGER or not type.minimum <= int(node.value) <= type.maximum:
            allowed = f"from {type.minimum} to {type.maximum}" if type.minimum < type.maximum else str(type.minimum)
            shown = node.value if len(node.value) <= _LONGEST_INTEGER else f"{node.value[:_LONGEST_INTEGER]}..."
            self.findings.append(BadValue.at(self.span(node), f"{subject} is {shown}; it must be {allowed}"))
            return None
        return int(node.value)

    def _number(self, node: ScalarNode, subject: str) -> Fraction | float | None:
        """Return a number: an exact fraction, or a float for nan and infinity.

        If the scalar is not a number, report it and return None.
        """
        if node.style or not _NUMBER.fullmatch(node.value):
            self.wrong(node, subject, "a number")
            return None
        if len(node.value) > _LONGEST_NUMBER or abs(_exponent(node.value)) > _LARGEST_EXPONENT:
            self.findings.append(
                BadValue.at(
                    self.span(node), f"{subject} is {node.value[:20]}..., which is too long or too large for a float"
                )
            )
            return None
        text = node.value.lower().replace(".inf", "inf").replace(".nan", "nan")
        return float(text) if text[-1] in "fn" else Fraction(text)

    def _boolean(self, node: ScalarNode, subject: str) -> bool | None:
        if node.value not in ("true", "false") or node.style:
            self.wrong(node, subject, "true or false")
            return None
        return bool(node.value == "true")

    def _duration(self, node: ScalarNode, type: Duration, subject: str) -> int | None:
        milliseconds = type.read(node.value)
        if milliseconds is None:
            message = f"{subject} is {node.value!r}; it must be from {type.minimum} ms to {type.maximum // 1000} s"
            help = "write a whole number with its unit, such as 500ms or 2s"
            self.findings.append(BadValue.at(self.span(node), message, help))
        return milliseconds

    def _data_rate(self, node: ScalarNode, type: DataRate, subject: str) -> int | None:
        rate = type.read(node.value)
        if rate is None:
            allowed = f"from {type.minimum // 1000} kB/s to {type.maximum // 1_000_000} MB/s"
            help = "write a whole number with its unit, such as 200 kB/s or 2 Mbit/s"
            self.findings.append(
                BadValue.at(self.span(node), f"{subject} is {node.value!r}; it must be {allowed}", help)
            )
        return rate

    def _as_written(self, node: ScalarNode, subject: str) -> str | None:
        if node.tag == _NULL:
            self.wrong(node, subject, kind_of(Scalar()))
            return None
        return str(node.value)

    def _text(self, node: ScalarNode, type: Text, subject: str) -> str | None:
        if node.tag == _NULL:
            self.wrong(node, subject, "a string")
            return None
        # PyYAML gives plain scalars a tag by the rules of YAML 1.1: yes, no, on and off are booleans, 1:30 is 90.
        if node.tag != "tag:yaml.org,2002:str":
            kinds = {"bool": "true or false", "int": "a number", "float": "a number", "timestamp": "a time"}
            # The part after `tag:yaml.org,2002:`, which is 18 characters long.
            kind = kinds.get(node.tag[18:], node.tag[18:])
            message = f"{subject} is {node.value}; YAML reads this as {kind}, not as a string"
            self.findings.append(SurprisingScalar.at(self.span(node), message, f'quote it: "{node.value}"'))
            return None
        return self._checked_text(node, type, subject)

    def _checked_text(self, node: ScalarNode, type: Text, subject: str) -> str | None:
        value: str = node.value
        if type.choices and value not in type.choices:
            help = nearest(value, type.choices, "")
            message = f"{subject} is {value!r}; it must be one of {', '.join(type.choices)}"
            self.findings.append(BadValue.at(self.span(node), message, help))
            return None
        message, help = type.fault(value) if type.fault else ("", "")
        if message:
            self.findings.append(BadValue.at(self.span(node), f"{subject} is {value!r}, {message}", help))
            return None
        if not value or (type.pattern and not type.checked_by_rule and not re.fullmatch(type.pattern, value)):
            self.bad(node, value, subject, type)
            return None
        return value

    def bad(self, node: Node, value: str, subject: str, type: Text) -> None:
        """Report a text that is empty or does not match the pattern of its type."""
        help = f"for example {type.example}" if type.example else ""
        message = f"{subject} is {value!r}, which is not a valid {type.noun}" if value else f"{subject} is empty"
        self.findings.append(BadValue.at(self.span(node), message, help))
