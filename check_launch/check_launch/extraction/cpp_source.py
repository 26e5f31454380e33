"""Reader of C++ sources: function calls with their arguments, and the classes in whose functions they stand.

This is no compiler: it reads one file at a time, follows no preprocessor condition (the code of all branches counts),
and needs no include path. That suffices for the calls with which ROS 2 nodes declare parameters and topics.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass

_TOKENS = re.compile(
    r'R"(?P<mark>[^()\s\\]{0,16})\((?:.|\n)*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|//[^\n]*|/\*(?:.|\n)*?\*/'
)
_SPACES = re.compile(r"\s*")
_BRACKETS = re.compile(r"[\"'()\[\]{}]")
_BLOCKS = re.compile(r"[\"'{}();]")
_NAMESPACE = re.compile(r"\bnamespace\s+([\w:]+)\s*$")
_CLASS = re.compile(r"\b(?:class|struct)\s+(?:[A-Z_]+\s+)?(\w+)\s*(?:final\s*)?(?::(?!:)\s*(?P<bases>.*))?$", re.DOTALL)
_FUNCTION = re.compile(r"([\w:]*\w)(?:<[^<>()]*>)?::~?\w+\s*[(\0]")
_PARENTHESES = re.compile(r"\([^()]*\)")
_INITIALIZERS = re.compile(r"\0[^\0:]*:(?!:)")
"""Beginning of a constructor's initializers, behind its arguments."""
_BASE = re.compile(r"\b(?:public|protected|private|virtual)\s+")
_IF = re.compile(r"(?P<other>else\b)?\s*(?:if\s*\((?P<condition>.*)\))?", re.DOTALL)
_ALIAS = re.compile(
    r"\b(?:using\s+(?P<name>\w+)\s*=\s*(?P<type>.+)|typedef\s+(?P<old>.+?)\s+(?P<new>\w+))\s*$", re.DOTALL
)


Conditions = tuple[tuple[str, bool], ...]
"""Conditions of C++, each with the truth value that it has where a branch runs."""


@dataclass(frozen=True, slots=True)
class Call:
    """A call of a function in a C++ file."""

    function: str
    """Name of the function without its namespace."""
    template: str
    """The arguments in angle brackets, such as ``nav_msgs::msg::Odometry``; empty if there are none."""
    receiver: str
    """The identifier on which the function is called, such as ``node``; empty if there is none."""
    arguments: tuple[str, ...]
    owner: str
    """Qualified name of the class whose function has the call; empty outside of classes."""
    position: int
    """Position of the call in the text."""


@dataclass(frozen=True, slots=True)
class DeclaredClass:
    """A class declaration, with the names of its base classes as they are written."""

    name: str
    bases: tuple[str, ...]


class CppSource:
    """The text of one C++ file without its comments."""

    def __init__(self, text: str) -> None:
        self.text, self._strings = _without_comments(text)
        self._lines = [match.start() for match in re.finditer("\n", text)]
        self.classes: list[DeclaredClass] = []
        """Classes that the file declares with a body."""
        self.aliases: list[tuple[str, str]] = []
        """Names of types that the file makes with `using` or `typedef`, and what each of them stands for."""
        self._owners: list[tuple[int, int, str, bool]] = []
        self._branches: list[tuple[int, int, Conditions]] = []
        self._read_blocks()

    def line(self, position: int) -> int:
        """Return the line number of a position in the text."""
        return bisect_right(self._lines, position - 1) + 1

    def owner(self, position: int) -> str:
        """Return the qualified name of the class around a position, or of the function's class; empty if none."""
        around = [(start, name) for start, end, name, _ in self._owners if name and start <= position < end]
        return max(around)[1] if around else ""

    def function_start(self, position: int) -> int:
        """Return the position at which the outermost function around a position begins."""
        around = [
            (end - start, start) for start, end, _, is_class in self._owners if not is_class and start <= position < end
        ]
        return max(around)[1] if around else 0

    def conditions(self, position: int) -> Conditions:
        """Return the conditions of the branches of ``if`` around a position, the outermost first.

        Branches without braces, and those of a lambda in an argument, are not known.
        """
        around = sorted((start, found) for start, end, found in self._branches if start <= position < end)
        return tuple(condition for _, found in around for condition in found)

    def calls(self, names: frozenset[str]) -> Iterator[Call]:
        """Yield the calls of functions with one of the names, in the order of the file."""
        if not any(name in self.text for name in names):
            return
        wanted = "|".join(sorted(map(re.escape, names), key=len, reverse=True))
        head = re.compile(rf"(?:\b(\w+)\s*(?:\.|->)\s*)?\b(?:\w+::)*({wanted})\b\s*")
        for match in head.finditer(self.text):
            if self.in_string(match.start(2)):
                continue
            position, template = match.end(), ""
            if self.text[position : position + 1] == "<":
                end = _closing_angle(self.text, position)
                if end is None:
                    continue
                template = " ".join(self.text[position + 1 : end].split())
                # a variable that is constructed, such as `Subscriber<T> sub(...)`, is no call
                position = _SPACES.match(self.text, end + 1).end()  # type: ignore[union-attr]  # it may be empty
            if self.text[position : position + 1] != "(":
                continue
            if (end := self._closing(position)) is None:
                continue
            arguments = tuple(split_arguments(self.text[position + 1 : end]))
            owner = self.owner(match.start())
            yield Call(match[2], template, match[1] or "", arguments, owner, match.start(2))

    def in_string(self, position: int) -> bool:
        """Return true if a position is inside of a literal text."""
        index = bisect_right(self._strings, (position, len(self.text)))
        return index > 0 and self._strings[index - 1][1] > position

    def _closing(self, opening: int) -> int | None:
        depth, position = 0, opening
        while match := _BRACKETS.search(self.text, position):
            position, character = match.end(), match[0]
            if character in "\"'":
                position = _end_of_literal(self.text, match.start())
                continue
            depth += 1 if character in "([{" else -1
            if depth == 0:
                return match.start()
        return None

    def _read_blocks(self) -> None:
        """Find the classes, and to which class each function belongs, by the text before each opening brace."""
        stack: list[tuple[str, str, int, Conditions]] = []  # kind, qualified name, start, conditions
        before: Conditions = ()  # those of the branch that was read last
        start, position, text, function = 0, 0, self.text, ""
        depth, is_odd = 0, False  # depth of the parentheses around the position
        while match := _BLOCKS.search(text, position):
            position, character = match.start(), match[0]
            if character in "\"'":
                position = _end_of_literal(text, position)
                continue
            if character == "{" and depth and not is_odd:  # a value, such as QoS{10}, or a lambda
                end = self._closing(position)
                is_odd = end is None  # brackets of which a preprocessor condition leaves one out
                position = (end or position) + 1
                continue
            if character == "{":
                outer = next((name for kind, name, *_ in reversed(stack) if kind in ("namespace", "class")), "")
                header = text[start:position]
                in_function = any(kind == "function" for kind, *_ in stack)
                kind, name = self._block(header, outer, in_function, function)
                if kind == "function" and not in_function:
                    function = name
                stack.append((kind, name, start, _conditions(header, before) if in_function else ()))
            elif character == "}" and stack:
                kind, name, began, before = stack.pop()
                if before:
                    self._branches.append((began, position, before))
                if kind in ("function", "class"):
                    self._owners.append((began, position, name, kind == "class"))
            elif character == ";" and (alias := _ALIAS.search(text, start, position)):
                scope = next((name for kind, name, *_ in reversed(stack) if kind != "block"), "")
                name = alias["name"] or alias["new"]
                meaning = " ".join((alias["type"] or alias["old"]).split())
                self.aliases.append((f"{scope}::{name}" if scope else name, meaning))
            depth = max(0, depth + (character == "(") - (character == ")"))
            if character in "{};":
                start, depth = position + 1, 0
            if character in "{;":
                before = ()  # an `else` behind it belongs to a branch without braces
            position += 1

    def _block(self, header: str, outer: str, in_function: bool, function: str) -> tuple[str, str]:
        if in_function:
            return "block", ""
        if match := _NAMESPACE.search(header):
            return "namespace", f"{outer}::{match[1]}" if outer else match[1]
        match = _CLASS.search(header)
        if match and "(" not in header[: match.start()] and "enum" not in header[: match.start()]:
            name = f"{outer}::{match[1]}" if outer else match[1]
            bases = tuple(
                re.sub(r"<.*", "", _BASE.sub("", base), flags=re.DOTALL).strip()
                for base in split_arguments(match["bases"] or "")
            )
            self.classes.append(DeclaredClass(name, bases))
            return "class", name
        if owner := _FUNCTION.search(_without_arguments(header)):
            name = owner[1]
            return "function", name if name.startswith(f"{outer}::") or not outer else f"{outer}::{name}"
        if not header.strip() or header.lstrip().startswith(","):  # after a constructor's initializers with braces
            return "function", function
        return ("function", outer) if "(" in header else ("block", "")


def _conditions(header: str, before: Conditions) -> Conditions:
    """Return the conditions of the block behind a header, from those of the block before it."""
    match = _IF.fullmatch(header.strip())
    if not match or not match[0]:
        return ()
    failed = (*before[:-1], (before[-1][0], False)) if before and match["other"] else ()
    return (*failed, (match["condition"].strip(), True)) if match["condition"] else failed


def split_arguments(text: str) -> list[str]:
    """Split the arguments of a call at its commas; commas in brackets and in literals do not separate."""
    parts, depth, start, position = [], 0, 0, 0
    while position < len(text):
        character = text[position]
        if character in "\"'":
            position = _end_of_literal(text, position)
            continue
        if character == "<" and (end := _closing_angle(text, position)) is not None:
            position = end + 1
            continue
        depth += (character in "([{") - (character in ")]}")
        if character == "," and depth == 0:
            parts.append(text[start:position].strip())
            start = position + 1
        position += 1
    last = text[start:].strip()
    return [*parts, last] if last or parts else []


def _without_arguments(header: str) -> str:
    """Return the text before a function's body with a null character for its arguments, and without its initializers.

    Both may name other classes: ``Camera(NodeOptions o = rclcpp::NodeOptions()) : rclcpp::Node("camera", o)``.
    """
    text = _TOKENS.sub('""', header)
    while (shorter := _PARENTHESES.sub("\0", text)) != text:
        text = shorter
    initializers = _INITIALIZERS.search(text)
    return text[: initializers.start() + 1] if initializers else text


def _closing_angle(text: str, opening: int) -> int | None:
    """Return the position of the bracket that closes a list of template arguments; None if it is a comparison."""
    depth = 0
    for position in range(opening, min(len(text), opening + 600)):
        character = text[position]
        if character in ";{}" or (character in "\"'" or text.startswith("&&", position)):
            return None
        if character == "<":
            depth += 1
        elif character == ">" and text[position - 1] != "-":
            depth -= 1
            if depth == 0:
                return position
    return None


def _end_of_literal(text: str, start: int) -> int:
    match = _TOKENS.match(text, start)
    return match.end() if match else start + 1


def _without_comments(text: str) -> tuple[str, list[tuple[int, int]]]:
    """Replace comments by spaces, so that lines and columns stay; return also the places of the literals."""
    strings: list[tuple[int, int]] = []

    def replaced(match: re.Match[str]) -> str:
        found = match[0]
        if found.startswith(("//", "/*")):
            return re.sub(r"[^\n]", " ", found)
        strings.append((match.start(), match.end()))
        return found

    return _TOKENS.sub(replaced, text), strings
