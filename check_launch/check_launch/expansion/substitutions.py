"""Substitutions of launch files: texts that depend on arguments, packages and the place of the file.

They are the ones of the packages launch and launch_ros, with the same constructors, because Python launch files create
them (see `stand_ins`). `perform` raises `UnknownTextError` if only the rover's computer knows the text.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Protocol

RUN_TIME = "(known at run time only)"
"""Text that stands for one that only the rover's computer knows, in a Python launch file."""
_LONGEST = 1 << 20  # letters; an argument that contains itself twice would double with each use


class UnknownTextError(Exception):
    """Raised for a text that is known at run time only, such as an argument without a default."""


class TooLongTextError(Exception):
    """Raised for a text that grows beyond all texts of launch files."""


class Surroundings(Protocol):
    """Values that a substitution may look at (see `launch_context.Context`)."""

    configurations: dict[str, str | None]
    environment: dict[str, str]
    file: str

    def share(self, package: str) -> str:
        """Return the share folder of a package."""

    def missing(self, name: str) -> None:
        """Note that an argument is used that nothing declares."""


class Substitution:
    """Base class of all substitutions."""

    def perform(self, context: Surroundings) -> str:
        """Return the text."""
        raise UnknownTextError(type(self).__name__)

    def stored(self) -> Any:
        """Return the substitution as JSON values, from which `from_stored` makes it again."""
        raise NotImplementedError(type(self).__name__)


class TextSubstitution(Substitution):
    """A text that does not change."""

    def __init__(self, *, text: str) -> None:
        self.text = text

    def perform(self, context: Surroundings) -> str:
        return self.text

    def stored(self) -> Any:
        return self.text


class LaunchConfiguration(Substitution):
    """The value of an argument."""

    def __init__(self, variable_name: Any, *, default: Any = None) -> None:
        self.variable_name, self.default = variable_name, default

    def perform(self, context: Surroundings) -> str:
        name = text_of(self.variable_name, context)
        if name in context.configurations:
            value = context.configurations[name]
            if value is None:
                raise UnknownTextError(name)
            return value
        if self.default is not None:
            return text_of(self.default, context)
        context.missing(name)
        raise UnknownTextError(name)

    def stored(self) -> Any:
        default = {} if self.default is None else {"default": stored_text(self.default)}
        return {"var": stored_text(self.variable_name), **default}


class EnvironmentVariable(Substitution):
    """A variable of the environment; unknown unless the launch file sets it, or gives a default."""

    def __init__(self, name: Any, *, default_value: Any = None) -> None:
        self.name, self.default_value = name, default_value

    def perform(self, context: Surroundings) -> str:
        name = text_of(self.name, context)
        if name in context.environment:
            return context.environment[name]
        if self.default_value is not None:
            return text_of(self.default_value, context)
        raise UnknownTextError(name)

    def stored(self) -> Any:
        default = {} if self.default_value is None else {"default": stored_text(self.default_value)}
        return {"env": stored_text(self.name), **default}


class FindPackageShare(Substitution):
    """The share folder of a package."""

    def __init__(self, package: Any) -> None:
        self.package = package

    def perform(self, context: Surroundings) -> str:
        return context.share(text_of(self.package, context))

    def stored(self) -> Any:
        return {"share": stored_text(self.package)}


class FindPackagePrefix(FindPackageShare):
    """The folder in which a package is installed."""

    def perform(self, context: Surroundings) -> str:
        raise UnknownTextError(text_of(self.package, context))


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file, or of the one that was included last."""

    def perform(self, context: Surroundings) -> str:
        return str(Path(context.file).parent)

    def stored(self) -> Any:
        return {"dirname": ""}


class ThisLaunchFile(Substitution):
    """The path of the launch file, or of the one that was included last."""

    def perform(self, context: Surroundings) -> str:
        return context.file

    def stored(self) -> Any:
        return {"filename": ""}


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined with slashes."""

    def __init__(self, substitutions: Iterable[Any]) -> None:
        self.substitutions = list(substitutions)

    def perform(self, context: Surroundings) -> str:
        return "/".join(text_of(substitution, context) for substitution in self.substitutions)

    def __truediv__(self, other: Any) -> PathJoinSubstitution:
        return PathJoinSubstitution([*self.substitutions, other])

    def stored(self) -> Any:
        return {"join": [stored_text(substitution) for substitution in self.substitutions]}


class PythonExpression(Substitution):
    """The value of a Python expression of literals, comparisons, arithmetic, conditions and methods of texts.

    Other expressions are unknown: no code of a launch file runs by this class.
    """

    def __init__(self, expression: Any, python_modules: Any = ()) -> None:
        self.expression = expression

    def perform(self, context: Surroundings) -> str:
        return str(evaluated(text_of(self.expression, context)))

    def stored(self) -> Any:
        return {"eval": stored_text(self.expression)}


class _Comparison(Substitution):
    name = ""

    def __init__(self, left: Any, right: Any) -> None:
        self.left, self.right = left, right

    def perform(self, context: Surroundings) -> str:
        left, right = text_of(self.left, context), text_of(self.right, context)
        return str(self.compared(left, right)).lower()

    def compared(self, left: str, right: str) -> bool:
        raise NotImplementedError

    def stored(self) -> Any:
        return {self.name: [stored_text(self.left), stored_text(self.right)]}


class EqualsSubstitution(_Comparison):
    """``true`` if two texts are equal."""

    name = "equals"

    def compared(self, left: str, right: str) -> bool:
        return left == right or (is_boolean(left) and is_boolean(right) and is_true(left) == is_true(right))


class NotEqualsSubstitution(EqualsSubstitution):
    """``true`` if two texts differ."""

    name = "not-equals"

    def compared(self, left: str, right: str) -> bool:
        return not super().compared(left, right)


class AndSubstitution(_Comparison):
    """``true`` if both conditions are true."""

    name = "and"

    def compared(self, left: str, right: str) -> bool:
        return is_true(left) and is_true(right)


class OrSubstitution(_Comparison):
    """``true`` if one of two conditions is true."""

    name = "or"

    def compared(self, left: str, right: str) -> bool:
        return is_true(left) or is_true(right)


class NotSubstitution(Substitution):
    """``true`` if a condition is false."""

    def __init__(self, value: Any) -> None:
        self.value = value

    def perform(self, context: Surroundings) -> str:
        return str(not is_true(text_of(self.value, context))).lower()

    def stored(self) -> Any:
        return {"not": stored_text(self.value)}


class IfElseSubstitution(Substitution):
    """One of two texts, by a condition."""

    def __init__(self, condition: Any, if_value: Any = "", else_value: Any = "") -> None:
        self.condition, self.if_value, self.else_value = condition, if_value, else_value

    def perform(self, context: Surroundings) -> str:
        chosen = self.if_value if is_true(text_of(self.condition, context)) else self.else_value
        return text_of(chosen, context)

    def stored(self) -> Any:
        return {"if-else": [stored_text(self.condition), stored_text(self.if_value), stored_text(self.else_value)]}


class AnonName(Substitution):
    """A name that is unique on the network; here, the name without the unique part."""

    def __init__(self, name: Any) -> None:
        self.name = name

    def perform(self, context: Surroundings) -> str:
        return text_of(self.name, context)

    def stored(self) -> Any:
        return {"anon": stored_text(self.name)}


class UnknownSubstitution(Substitution):
    """A substitution whose text only the rover's computer knows, such as the output of a command."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.arguments = arguments

    def stored(self) -> Any:
        return {"unknown": ""}


def text_of(value: Any, context: Surroundings) -> str:
    """Return the text of a value of a launch file: a text, a substitution, or several of them in a row.

    Raises `UnknownTextError` if it is known at run time only, and `TooLongTextError`.
    """
    text = _text_of(value, context)
    if len(text) > _LONGEST:
        raise TooLongTextError(f"a text has more than {_LONGEST} letters")
    if RUN_TIME in text:
        raise UnknownTextError(text)
    return text


def _text_of(value: Any, context: Surroundings) -> str:
    if isinstance(value, str):
        return value
    if hasattr(value, "perform"):  # substitutions of a launch file may be classes of its own
        return str(value.perform(context))
    if isinstance(value, Iterable) and not isinstance(value, Mapping):
        return "".join(text_of(part, context) for part in value)
    if isinstance(value, Path | int | float | bool):
        return str(value)
    raise UnknownTextError(type(value).__name__)


def stored_text(value: Any) -> Any:
    """Return a text of a launch file as JSON values; see `Substitution.stored`."""
    if isinstance(value, Substitution):
        return value.stored()
    if isinstance(value, list | tuple):
        parts = [stored_text(part) for part in value]
        return parts[0] if len(parts) == 1 else {"text": parts}
    if isinstance(value, str | int | float | bool):
        return value
    raise NotImplementedError(type(value).__name__)


def from_stored(value: Any) -> Any:
    """Return the text or substitution that `stored_text` has made JSON values of."""
    if not isinstance(value, dict):
        return value
    if "text" in value:
        return [from_stored(part) for part in value["text"]]
    if "var" in value:
        return LaunchConfiguration(from_stored(value["var"]), default=from_stored(value.get("default")))
    if "env" in value:
        return EnvironmentVariable(from_stored(value["env"]), default_value=from_stored(value.get("default")))
    name, inner = next(iter(value.items()))
    if name == "join":
        return PathJoinSubstitution([from_stored(part) for part in inner])
    if name == "if-else":
        return IfElseSubstitution(*(from_stored(part) for part in inner))
    if name in _COMPARISONS:
        return _COMPARISONS[name](*(from_stored(part) for part in inner))
    return _SINGLE[name](from_stored(inner)) if name in _SINGLE else _WITHOUT[name]()


_COMPARISONS: Mapping[str, type[_Comparison]] = {
    comparison.name: comparison
    for comparison in (EqualsSubstitution, NotEqualsSubstitution, AndSubstitution, OrSubstitution)
}
_SINGLE: Mapping[str, Any] = {
    "share": FindPackageShare,
    "eval": PythonExpression,
    "not": NotSubstitution,
    "anon": AnonName,
}
_WITHOUT: Mapping[str, Any] = {
    "dirname": ThisLaunchFileDir,
    "filename": ThisLaunchFile,
    "unknown": UnknownSubstitution,
}


def is_boolean(text: str) -> bool:
    """Return true if a text is a truth value for the conditions of launch files."""
    return text.strip().lower() in ("true", "false", "1", "0")


def is_true(text: str) -> bool:
    """Return the truth value of a text. Raises `UnknownTextError` if it is none."""
    if not is_boolean(text):
        raise UnknownTextError(text)
    return text.strip().lower() in ("true", "1")


_NAMES: Mapping[str, Any] = {"true": True, "false": False, "True": True, "False": False, "None": None, "pi": math.pi}
_FUNCTIONS: Mapping[str, Any] = {
    "str": str,
    "int": int,
    "float": float,
    "bool": bool,
    "len": len,
    "abs": abs,
    "min": min,
    "max": max,
}
_TEXT_METHODS = frozenset(
    {"replace", "lower", "upper", "strip", "lstrip", "rstrip", "startswith", "endswith", "split", "join"}
)
_COMPARED: Mapping[type[ast.cmpop], Any] = {
    ast.Eq: lambda a, b: a == b,
    ast.NotEq: lambda a, b: a != b,
    ast.Lt: lambda a, b: a < b,
    ast.LtE: lambda a, b: a <= b,
    ast.Gt: lambda a, b: a > b,
    ast.GtE: lambda a, b: a >= b,
    ast.In: lambda a, b: a in b,
    ast.NotIn: lambda a, b: a not in b,
    ast.Is: lambda a, b: a is b,
    ast.IsNot: lambda a, b: a is not b,
}
_CALCULATED: Mapping[type[ast.operator], Any] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b if not isinstance(a, str | list) and not isinstance(b, str | list) else None,
    ast.Div: lambda a, b: a / b,
    ast.Mod: lambda a, b: a % b if not isinstance(a, str) else None,
}


def evaluated(text: str, names: Mapping[str, Any] = _NAMES) -> Any:
    """Return the value of a Python expression (see `PythonExpression`). Raises `UnknownTextError` for any other."""
    try:
        return _value(_parsed(text.strip()), names)
    except (SyntaxError, TypeError, ValueError, ZeroDivisionError, AttributeError, RecursionError, KeyError) as error:
        raise UnknownTextError(text) from error


@lru_cache(1000)
def _parsed(text: str) -> ast.expr:
    """Parse an expression; the conditions of the catalogue come again for each node."""
    return ast.parse(text, mode="eval").body


def _value(node: ast.expr, names: Mapping[str, Any]) -> Any:
    if isinstance(node, ast.Constant):
        return node.value
    if isinstance(node, ast.Name) and node.id in names:
        return names[node.id]
    if isinstance(node, ast.BoolOp):
        value: Any = isinstance(node.op, ast.And)
        for operand in node.values:
            value = _value(operand, names)
            if bool(value) != isinstance(node.op, ast.And):
                break
        return value
    if isinstance(node, ast.UnaryOp):
        inner = _value(node.operand, names)
        return not inner if isinstance(node.op, ast.Not) else -inner if isinstance(node.op, ast.USub) else inner
    if isinstance(node, ast.Compare):
        left = _value(node.left, names)
        for operator, right_node in zip(node.ops, node.comparators, strict=True):
            right = _value(right_node, names)
            if not _COMPARED[type(operator)](left, right):
                return False
            left = right
        return True
    if isinstance(node, ast.BinOp):
        return _CALCULATED[type(node.op)](_value(node.left, names), _value(node.right, names))
    if isinstance(node, ast.IfExp):
        return _value(node.body if _value(node.test, names) else node.orelse, names)
    if isinstance(node, ast.List | ast.Tuple):
        return [_value(element, names) for element in node.elts]
    if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant):
        return _value(node.value, names)[node.slice.value]
    if isinstance(node, ast.Call) and not node.keywords:
        arguments = [_value(argument, names) for argument in node.args]
        if isinstance(node.func, ast.Name) and node.func.id in _FUNCTIONS:
            return _FUNCTIONS[node.func.id](*arguments)
        if isinstance(node.func, ast.Attribute) and node.func.attr in _TEXT_METHODS:
            owner = _value(node.func.value, names)
            if isinstance(owner, str):
                return getattr(owner, node.func.attr)(*arguments)
    raise UnknownTextError(ast.dump(node))
