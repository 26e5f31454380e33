"""Values of C++ expressions: names of parameters and topics as patterns, and default values with their ROS 2 types.

A pattern is a text in which ``{x}`` stands for the value of the variable x, which is known at run time only:
``name_ + "." + source + ".topic"`` gives ``{name_}.{source}.topic``.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from check_launch.extraction.cpp_source import CppSource, split_arguments

_LITERAL = re.compile(r'(?:"(?:\\.|[^"\\])*"\s*)+')
_WRAPPED = re.compile(
    r"^(?:(?:rclcpp::)?ParameterValue|(?:std::)?string|(?:const\s+)?std::string|create_graph_resource_name|rclcpp::Parameter)"
    r"\s*[({](?P<inner>.*)[)}]$",
    re.DOTALL,
)
_CAST = re.compile(
    r"^(?:static_cast\s*<(?P<to>[^<>]*)>\s*|\((?P<old>(?:unsigned )?(?:int|float|double|bool|std::string))\)\s*)"
)
_VECTOR = re.compile(r"^(?:std::)?vector\s*<\s*(?P<of>[\w: ]+?)\s*>\s*(?:[({](?P<inner>.*)[)}])?$", re.DOTALL)
_NUMBER = re.compile(r"^[-+]?\s*(?:\d+\.\d*|\.\d+|\d+)(?:[eE][-+]?\d+)?(?P<suffix>[fFuUlL]*)$")
_RESOLVED = re.compile(r"resolve_topic(?:_or_service)?_name\(\s*(\"[^\"]*\")")
_READ = re.compile(r"get_parameter\(([^()]*)\)\s*\.\s*as_string\(\)$")
_OF_PARAMETER_TYPE = re.compile(r"PARAMETER_(BOOL|INTEGER|DOUBLE|STRING)(_ARRAY)?\b")
_IDENTIFIER = re.compile(r"^(?:this->)?[A-Za-z_]\w*$")
_STATEMENT = r'(?:"(?:\\.|[^"\\\n])*"|[^;"])'
"""Part of a statement: a literal, which may have a semicolon, or another character."""
_TYPE = re.compile(r"\b((?:std::)?[\w:]+(?:<[\w:, ]+>)?)\s+&?\s*$")
"""Type of a variable whose name follows."""
_LONGEST_TYPE = 200
_STATEMENT_START, _STATEMENT_END = 300, 4000  # most characters of a declaration before and after the name
_QUALIFIERS = r"(?:(?:static|const|constexpr|inline|mutable)\s+)*"
TYPES: Mapping[str, str] = {
    "bool": "bool",
    "double": "double",
    "float": "double",
    "std::string": "string",
    "string": "string",
    **dict.fromkeys(
        (
            "int",
            "unsigned",
            "unsigned int",
            "size_t",
            "std::size_t",
            "unsigned char",
            "uint8_t",
            "int64_t",
            "long",
            "uint64_t",
        ),
        "integer",
    ),
    **dict.fromkeys(("uint", "uint32_t", "int32_t", "int8_t", "uint16_t", "unsigned long", "long int"), "integer"),
}
"""ROS 2 type of a parameter by the C++ type of its value."""

Value = tuple[str, Any]
"""Type of a parameter, such as ``double_array`` (empty if it is not known), and its default (None if not known)."""

UNKNOWN: Value = ("", None)


class Scope:
    """Variables that are visible at one place of a file: those of the function, and the members of its class."""

    def __init__(
        self,
        source: CppSource,
        position: int,
        members: Callable[[str], str | None],
        member_type: Callable[[str], str | None],
    ) -> None:
        """``members`` returns the first value of a member or a constant, ``member_type`` its C++ type."""
        self._source, self._position = source, position
        self._members, self._member_type = members, member_type
        self._before = source.text[source.function_start(position) : position]

    def pattern(self, expression: str, depth: int = 0) -> str:
        """Return the text that an expression gives, with ``{x}`` for what is not known."""
        return "".join(self._part(part, depth) for part in _split_sum(expression))

    def value(self, expression: str, depth: int = 0) -> Value:
        """Return the type and the value of the default of a parameter."""
        text = expression.strip()
        if found := _OF_PARAMETER_TYPE.search(text):
            return found[1].lower() + (found[2] or "").lower(), None
        if match := _CAST.match(text):
            kind = TYPES.get((match["to"] or match["old"]).strip(), "")
            inner = self.value(_unparenthesized(text[match.end() :]), depth)
            return kind or inner[0], inner[1] if _fits(kind, inner[1]) else None
        if match := _VECTOR.match(text):
            return self._vector(match["of"], match["inner"], depth)
        if (match := _WRAPPED.match(text)) and _is_one(text):
            inner_text = match["inner"].strip()
            if not inner_text:
                return "string", ""
            inner = self.value(inner_text, depth)
            return ("string", inner[1]) if "string" in text[: match.start("inner")] else inner
        return self._plain(text, depth)

    def written_with(self, name: str) -> str:
        """Return all statements of the function before the place that begin with a variable or declare it."""
        pattern = rf"\b{re.escape(name)}\s*(?:=(?!=)[^;]*|[({{.][^;]*);"
        return " ".join(match[0] for match in re.finditer(pattern, self._before))

    def is_conditional(self, name: str) -> bool:
        """Return true if the function changes a variable in a block of its own, so that the value depends on others."""
        return bool(re.search(rf"\bif\s*\([^{{}};]*\)\s*\{{\s*{re.escape(name)}\b[^;]*;", self._before))

    def _plain(self, text: str, depth: int) -> Value:
        if text in ("true", "false"):
            return "bool", text == "true"
        if match := _NUMBER.match(text):
            digits = text.rstrip("fFuUlL").replace(" ", "")
            is_double = "f" in match["suffix"].lower() or any(c in digits for c in ".eE")
            return ("double", float(digits)) if is_double else ("integer", int(digits))
        if _LITERAL.fullmatch(text):
            return "string", _literal(text)
        if text.startswith("{") and text.endswith("}"):
            return self._vector("std::string" if '"' in text else "", text[1:-1], depth)
        if _IDENTIFIER.match(text) and depth < 4:
            name = text.removeprefix("this->")
            declared = self._declared_type(name)
            first = self._assigned(name) or self._members(name)
            found = self.value(first, depth + 1) if first and first != name else UNKNOWN
            if declared.endswith("_array") and first and not isinstance(found[1], list):
                found = self._vector("", first, depth)
            return declared or found[0], found[1] if not declared or _fits(declared, found[1]) else None
        if "std::numeric_limits<double>" in text or "M_PI" in text:
            return "double", None
        if re.fullmatch(r"[-\w.\s*/+()]+", text) and re.search(r"\d\.\d|\d\.", text):
            return "double", None
        return UNKNOWN

    def _vector(self, of: str, inner: str | None, depth: int) -> Value:
        kind = TYPES.get(of.strip(), "")
        items = [self.value(item, depth) for item in split_arguments(_unbraced(inner or ""))]
        kind = kind or (items[0][0] if items else "")
        if kind == "double":
            items = [(kind, float(value)) if isinstance(value, int | float) else (kind, None) for _, value in items]
        values = [value for _, value in items]
        return f"{kind}_array" if kind else "", None if None in values else values

    def _part(self, part: str, depth: int) -> str:
        text = part.strip()
        if _LITERAL.fullmatch(text):
            return _literal(text)
        if (match := _WRAPPED.match(text)) and _is_one(text):
            return self.pattern(match["inner"], depth)
        if text.startswith("(") and _is_one(text):
            return self.pattern(text[1:-1], depth)
        if match := _RESOLVED.search(text):
            return self.pattern(match[1], depth + 1)
        if match := _READ.search(text):
            return f"$({self.pattern(match[1], depth + 1)})"
        if re.fullmatch(r"(?:\w+(?:->|\.))?get_name\(\)", text):
            return "{node}"
        if text.endswith(".c_str()"):
            return self._part(text.removesuffix(".c_str()"), depth)
        if text.endswith(".str()") and (streamed := self._streamed(text.removesuffix(".str()"))):
            return "".join(self._part(part, depth + 1) for part in streamed)
        if _IDENTIFIER.match(text) and depth < 4:
            name = text.removeprefix("this->")
            first = self._assigned(name) or self._members(name)
            if first and first != name and '"' in first + (self._streamed_text(first) or ""):
                return self.pattern(first, depth + 1)
            return f"{{{name}}}"
        if re.fullmatch(r"\w+\+\+", text):
            return "{#}"
        return "{" + re.sub(r"[{}\s]", "", text) + "}"

    def _assigned(self, name: str) -> str | None:
        """Return what the function assigns last to a variable before the place; None if it assigns nothing."""
        found = None
        pattern = (
            rf"\b{re.escape(name)}\s*(?:(?<![=!<>])=(?!=)\s*(?P<a>{_STATEMENT}+);"
            rf"|\((?P<b>{_STATEMENT}*?)\)\s*;|\{{(?P<c>[^;{{}}]*)\}}\s*;)"
        )
        for match in re.finditer(pattern, self._before):
            before = self._before[: match.start()].rstrip()
            if match["a"] is None and not re.search(r"[\w>&*]$", before):
                continue  # a call, not a variable with a first value
            if match["a"] is None and re.search(r"\breturn$", before):
                continue
            found = match["a"] or match["b"] or match["c"]
        if found and ("declare_parameter" in found or "get_parameter" in found):
            return None
        return found.strip() if found else None

    def _streamed(self, name: str) -> list[str] | None:
        """Return the expressions that the function has written into a string stream."""
        if not _IDENTIFIER.match(name):
            return None
        start = max((m.end() for m in re.finditer(rf"stringstream\s+{re.escape(name)}\b", self._before)), default=-1)
        if start < 0:
            return None
        found: list[str] = []
        for match in re.finditer(rf"\b{re.escape(name)}\s*<<\s*([^;]+);", self._before[start:]):
            found += [part.strip() for part in match[1].split("<<")]
        return found

    def _streamed_text(self, expression: str) -> str | None:
        if not expression.endswith(".str()"):
            return None
        return "".join(self._streamed(expression.removesuffix(".str()")) or [])

    def _declared_type(self, name: str) -> str:
        uses = [use.start() for use in re.finditer(rf"\b{re.escape(name)}\s*[=;({{]", self._before)]
        texts = (self._before[max(0, end - _LONGEST_TYPE) : end] for end in reversed(uses))
        written = next((match[1] for text in texts if (match := _TYPE.search(text))), None) or self._member_type(name)
        if not written:
            return ""
        if match := _VECTOR.match(written):
            inner = TYPES.get(match["of"].strip(), "")
            return f"{inner}_array" if inner else ""
        return TYPES.get(written.strip(), "")


def _fits(kind: str, value: Any) -> bool:
    accepted: Mapping[str, type | tuple[type, ...]] = {
        "bool": bool,
        "integer": int,
        "double": (int, float),
        "string": str,
    }
    return not kind or (
        kind.endswith("_array") == isinstance(value, list)
        and (kind.endswith("_array") or isinstance(value, accepted[kind]))
    )


def _literal(text: str) -> str:
    return "".join(ast.literal_eval(literal) for literal in re.findall(r'"(?:\\.|[^"\\])*"', text))


def _split_sum(expression: str) -> Iterator[str]:
    """Yield the parts of a sum of texts: ``name_ + ".x"`` has two."""
    depth, start, literal = 0, 0, ""
    for index, character in enumerate(expression):
        if literal:
            literal = "" if character == literal and expression[index - 1] != "\\" else literal
        elif character in "\"'":
            literal = character
        else:
            depth += (character in "([{") - (character in ")]}")
            around = expression[index - 1 : index + 2]
            if character == "+" and depth == 0 and "++" not in around:
                yield expression[start:index]
                start = index + 1
    yield expression[start:]


def _is_one(text: str) -> bool:
    """Return true if the bracket that the text ends with belongs to the first one in it."""
    closing = {"(": ")", "{": "}"}
    opening = next((index for index, character in enumerate(text) if character in closing), None)
    if opening is None:
        return False
    depth = 0
    for index in range(opening, len(text)):
        depth += (text[index] in "({") - (text[index] in ")}")
        if depth == 0:
            return index == len(text) - 1
    return False


def _unparenthesized(text: str) -> str:
    text = text.strip()
    return text[1:-1] if text.startswith("(") and _is_one(text) else text


def _unbraced(text: str) -> str:
    text = text.strip()
    return text[1:-1] if text.startswith("{") and text.endswith("}") else text


def first_values(texts: Sequence[str], name: str) -> str | None:
    """Return the value with which a member or constant begins, from the texts that may declare or initialize it."""
    escaped = re.escape(name)
    of_constructor = re.compile(
        rf"[:,]\s*{escaped}\s*[({{](?P<v>(?:[^(){{}}]|[({{][^(){{}}]*[)}}])*)[)}}]\s*(?=[,{{]|\n)"
    )
    declared = re.compile(
        rf"(?:^|[;{{}}:\n])\s*{_QUALIFIERS}[\w:]+(?:<[^<>;]*>)?\s*[&*]?\s+{escaped}\s*(?:\[\]\s*)?"
        rf"(?:=\s*(?P<a>{_STATEMENT}+);|\{{(?P<b>[^;]*)\}}\s*;|\((?P<c>\"[^;]*)\)\s*;)"
    )
    defined = re.compile(rf"^\s*#define\s+{escaped}\s+(?P<d>\"[^\n]*\"|[-\d.]+)\s*$", re.MULTILINE)
    given = re.compile(rf"\b{escaped}\s*(?:\[\]\s*)?[=({{]")
    places = [(text, found.start()) for text in texts if name in text for found in given.finditer(text)]
    for pattern in (of_constructor, declared):
        for text, place in places:
            if match := pattern.search(text, max(0, place - _STATEMENT_START), place + _STATEMENT_END):
                return next((value.strip() for value in match.groups() if value is not None), None)
    found = next(filter(None, (defined.search(text) for text in texts if name in text)), None)
    return found["d"].strip() if found else None


def declared_type(texts: Sequence[str], name: str) -> str | None:
    """Return the C++ type with which a member is declared."""
    pattern = re.compile(
        rf"(?:^|[;{{}}:\n])\s*{_QUALIFIERS}((?:std::)?[\w:]+(?: int| char)?(?:<[\w:, ]+>)?)\s+"
        rf"(?:\w+\s*,\s*)*{re.escape(name)}\s*(?:[;={{,]|\([^)]*\)\s*;)"
    )
    uses = re.compile(rf"\b{re.escape(name)}\s*[;={{,(]")
    places = [(text, use) for text in texts if name in text for use in uses.finditer(text)]
    for text, use in places:
        match = pattern.search(text, max(0, use.start() - _LONGEST_TYPE), use.end() + _STATEMENT_START)
        if match and match[1] not in ("return", "else", "new"):
            return match[1]
    return None
