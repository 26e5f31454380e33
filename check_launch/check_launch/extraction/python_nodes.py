"""Facts about the Python nodes of one package: the parameters that they declare, and their topics and services.

A file is read as a syntax tree, and never runs. A class is partial if it calls what may declare more.
"""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from check_launch.extraction.class_facts import DYNAMIC_TYPING, ClassFacts, EndpointFact, ParameterFact
from roverlink import bounded_files

_NODES = {"Node": "rclpy::Node", "LifecycleNode": "rclpy::LifecycleNode"}
_ENDPOINTS = {
    # function: kind, and positions of the type and the name among the arguments, and of the QoS
    "create_publisher": ("publisher", 0, 1, 2),
    "create_lifecycle_publisher": ("publisher", 0, 1, 2),
    "create_subscription": ("subscription", 0, 1, 3),
    "create_service": ("service", 0, 1, None),
    "create_client": ("client", 0, 1, None),
    "ActionServer": ("action", 1, 2, None),
    "ActionClient": ("action_client", 1, 2, None),
    "Subscriber": ("subscription", 1, 2, None),  # of message_filters; its QoS is an option
}
_NAMES = {
    "publisher": ("msg_type", "topic"),
    "subscription": ("msg_type", "topic"),
    "service": ("srv_type", "srv_name"),
}
_NAMES |= {"client": _NAMES["service"], "action": ("action_type", "action_name")}
_NAMES["action_client"] = _NAMES["action"]
_HARMLESS = frozenset(
    {"ActionServer", "ActionClient", "Subscriber", "TransformListener", "TransformBroadcaster", "super", "print", "str"}
    | {"StaticTransformBroadcaster", "spin", "spin_once", "spin_until_future_complete", "hasattr", "getattr", "setattr"}
    | {"isinstance", "type", "id", "repr", "add_node", "Thread", "SingleThreadedExecutor", "MultiThreadedExecutor"}
)
_DECLARING = frozenset({"self.declare_parameter", "self.declare_parameters"})
_OPEN = frozenset({"automatically_declare_parameters_from_overrides", "allow_undeclared_parameters"})
_TYPES: Mapping[type, str] = {bool: "bool", int: "integer", float: "double", str: "string"}
_OF_TYPE = re.compile(r"^(?:PARAMETER_)?(BOOL|INTEGER|DOUBLE|STRING)(_ARRAY)?$")


@dataclass(slots=True)
class PythonNodes:
    """Node classes of a package."""

    classes: dict[str, ClassFacts] = field(default_factory=dict)
    """Classes of nodes by their names, such as ``my_package.camera.CameraNode``."""
    of_module: dict[str, str] = field(default_factory=dict)
    """Name of the node class that a module starts, by the module; empty if it is not known."""


def python_nodes(folder: Path) -> PythonNodes:
    """Read the Python files of the package in a folder, without its tests and launch files."""
    found = PythonNodes()
    for path in sorted(folder.rglob("*.py")):
        inner = path.relative_to(folder)
        if {"test", "tests", "launch"} & set(inner.parts[:-1]) or inner.name == "setup.py":
            continue
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of escapes in a stranger's texts
                tree = ast.parse(bounded_files.read(path))
        except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
            continue
        module = ".".join(inner.with_suffix("").parts)
        _Module(module, tree).read(found)
    return found


class _Module:
    """One file."""

    def __init__(self, name: str, tree: ast.Module) -> None:
        self._name, self._body, self._parts = name, tree.body, [*ast.walk(tree)]
        self._imported: dict[str, str] = {}
        self._constants: dict[str, ast.expr] = {}

    def read(self, found: PythonNodes) -> None:
        """Add the classes of the file."""
        for node in self._parts:
            if isinstance(node, ast.Import):
                for alias in node.names:
                    self._imported[alias.asname or alias.name.partition(".")[0]] = (
                        alias.name if alias.asname else alias.name.partition(".")[0]
                    )
            elif isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    self._imported[alias.asname or alias.name] = f"{node.module}.{alias.name}"
        for node in self._body:
            if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
                self._constants[node.targets[0].id] = node.value
        own: dict[str, str] = {}
        for node in self._body:
            if isinstance(node, ast.ClassDef) and (bases := self._bases(node, own)):
                own[node.name] = f"{self._name}.{node.name}"
                found.classes[own[node.name]] = self._class(own[node.name], bases, node)
        calls = [part.func for part in self._parts if isinstance(part, ast.Call)]
        started = [call.id for call in calls if isinstance(call, ast.Name) and call.id in own]
        makes_others = any(_short(call) in ("create_node", "Node") for call in calls)
        started = list(dict.fromkeys(started)) or list(own)
        if own or makes_others or self._imported_node_is_started():
            found.of_module[self._name] = own[started[0]] if len(started) == 1 and not makes_others else ""

    def _imported_node_is_started(self) -> bool:
        return "rclpy" in self._imported

    def _bases(self, node: ast.ClassDef, own: Mapping[str, str]) -> tuple[str, ...]:
        """Return the base classes of a node class; none if it is no node."""
        names = [_dotted(base) for base in node.bases]
        found = []
        for name in names:
            full = self._full(name)
            if full.startswith("rclpy") and full.rpartition(".")[2] in _NODES:
                found.append(_NODES[full.rpartition(".")[2]])
            elif name in own:
                found.append(own[name])
        return tuple(found + [name for name in names if name not in own and not self._is_node(name)] if found else ())

    def _is_node(self, name: str) -> bool:
        full = self._full(name)
        return full.startswith("rclpy") and full.rpartition(".")[2] in _NODES

    def _full(self, name: str) -> str:
        first, dot, rest = name.partition(".")
        return self._imported.get(first, first) + dot + rest

    def _class(self, name: str, bases: tuple[str, ...], node: ast.ClassDef) -> ClassFacts:
        facts = ClassFacts(name, bases)
        # What a variable gets from a parameter, and what it is assigned once.
        links: dict[str, str] = {}
        values = dict(self._constants)
        functions: dict[str, str] = {}
        parts = [*ast.walk(node)]
        for part in parts:
            if isinstance(part, ast.Assign) and len(part.targets) == 1:
                target = _dotted(part.targets[0])
                if not target or target.startswith("."):
                    continue  # an item of a list, or a part of one
                values[target] = part.value
                if (function := _dotted(part.value)) in _DECLARING:
                    functions[target] = function
                if read := _read_parameter(part.value):
                    links[target] = read
        reader = _Reader(facts, values, links, functions, self._type)
        for part in parts:
            if isinstance(part, ast.Call):
                reader.call(part)
        unknown = [base for base in bases if "::" not in base and "." not in base and base not in ("object", "ABC")]
        facts.is_partial = facts.is_partial or bool(unknown)
        # Descriptors may stand anywhere in the file.
        if any(getattr(part, "arg", getattr(part, "attr", "")) == DYNAMIC_TYPING for part in self._parts):
            facts.parameters = {key: replace(fact, type="") for key, fact in facts.parameters.items()}
        return facts

    def _type(self, node: ast.expr | None) -> str:
        """Return a message type such as ``sensor_msgs/msg/Image``; empty if it is not known."""
        parts = self._full(_dotted(node)).split(".") if node is not None else []
        kinds = [index for index, part in enumerate(parts) if part in ("msg", "srv", "action")]
        return f"{parts[kinds[0] - 1]}/{parts[kinds[0]]}/{parts[-1]}" if kinds and kinds[0] > 0 else ""


class _Reader:
    """Reader of the calls in a node class."""

    def __init__(
        self,
        facts: ClassFacts,
        values: Mapping[str, ast.expr],
        links: Mapping[str, str],
        functions: Mapping[str, str],
        type_of: Any,
    ) -> None:
        """``functions`` are those of the node that variables stand for, as in ``p = self.declare_parameter``."""
        self._facts, self._values, self._links, self._type_of = facts, values, links, type_of
        self._functions = functions

    def call(self, call: ast.Call) -> None:
        """Note what a call declares."""
        called = self._functions.get(_dotted(call.func), _dotted(call.func))
        owner, _, function = called.rpartition(".")
        options = {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg}
        if function == "__init__" and owner == "super()" and call.args:
            self._facts.default_name = self._facts.default_name or self._text(call.args[0])
        if _OPEN & set(options):
            self._facts.is_partial = True
        if function == "declare_parameter" and owner == "self":
            name = call.args[0] if call.args else options.get("name")
            self._declare(name, call.args[1] if len(call.args) > 1 else options.get("value"))
        elif function == "declare_parameters" and owner == "self":
            self._declare_all(call.args, options)
        elif function in _ENDPOINTS and (owner == "self" or _is_self(call.args[:1])):
            self._endpoint(*_ENDPOINTS[function], call, options)
        elif function not in _HARMLESS and any(
            _dotted(given) in ("self", *_DECLARING) for given in (*call.args, *options.values())
        ):
            self._facts.is_partial = True  # another object gets the node, and may declare more

    def _declare_all(self, arguments: list[ast.expr], options: Mapping[str, ast.expr]) -> None:
        namespace = self._text(arguments[0] if arguments else options.get("namespace"))
        listed = arguments[1] if len(arguments) > 1 else options.get("parameters")
        listed = self._values.get(_dotted(listed), listed) if listed is not None else None
        for item in listed.elts if isinstance(listed, ast.List | ast.Tuple) else [None]:
            if isinstance(item, ast.Tuple | ast.List) and item.elts:
                self._declare(item.elts[0], item.elts[1] if len(item.elts) > 1 else None, namespace)
            else:
                self._facts.is_partial = True

    def _declare(self, name: ast.expr | None, value: ast.expr | None, namespace: str = "") -> None:
        text = self._text(name)
        if not text:
            self._facts.is_partial = True
            return
        type_, default = self._value(value)
        self._facts.parameters[f"{namespace}.{text}" if namespace else text] = ParameterFact(type_, default)

    def _endpoint(
        self, kind: str, type_at: int, name_at: int, qos_at: int | None, call: ast.Call, options: Mapping[str, ast.expr]
    ) -> None:
        type_name, topic_name = _NAMES[kind]
        type_ = call.args[type_at] if len(call.args) > type_at else options.get(type_name)
        name = call.args[name_at] if len(call.args) > name_at else options.get(topic_name)
        topic = self._topic(name)
        if not topic:
            self._facts.is_partial = True
            return
        qos = None
        if qos_at is not None:
            qos = call.args[qos_at] if len(call.args) > qos_at else options.get("qos_profile")
        reliability, durability = self._qos(qos) if kind in ("publisher", "subscription") else ("", "")
        fact = EndpointFact(kind, topic, self._type_of(type_), reliability, durability)
        if fact not in self._facts.endpoints:
            self._facts.endpoints.append(fact)

    def _topic(self, node: ast.expr | None) -> str:
        """Return the name of a topic, ``$(x)`` for the value of the parameter x; empty if it is not known."""
        if read := _read_parameter(node):
            return f"$({read})"
        written = _dotted(node) if node is not None else ""
        if written in self._links:
            return f"$({self._links[written]})"
        if isinstance(node, ast.JoinedStr) or (isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add)):
            parts = node.values if isinstance(node, ast.JoinedStr) else [node.left, node.right]
            texts = [self._topic(part.value if isinstance(part, ast.FormattedValue) else part) for part in parts]
            return "".join(texts) if all(texts) else ""
        return self._text(node)

    def _text(self, node: ast.expr | None, depth: int = 0) -> str:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            return node.value
        name = _dotted(node) if node is not None else ""
        return self._text(self._values[name], depth + 1) if name in self._values and depth < 4 else ""

    def _value(self, node: ast.expr | None) -> tuple[str, Any]:
        """Return the type of a parameter and its default."""
        if node is None:
            return "", None
        if found := _OF_TYPE.match(_dotted(node).rpartition(".")[2]):
            return found[1].lower() + (found[2] or "").lower(), None
        name = _dotted(node)
        try:
            value = ast.literal_eval(self._values.get(name, node))
        except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError):
            return "", None
        if isinstance(value, list | tuple):
            kinds = {_TYPES.get(type(item), "") for item in value}
            return (f"{kinds.pop()}_array" if len(kinds) == 1 and "" not in kinds else ""), list(value)
        kind = _TYPES.get(type(value), "")
        return kind, value if kind else None

    def _qos(self, node: ast.expr | None) -> tuple[str, str]:
        """Return reliability and durability; both are empty if they are not known."""
        name = _dotted(node) if node is not None else ""
        node = self._values.get(name, node)
        if isinstance(node, ast.Constant) and isinstance(node.value, int):
            return "reliable", "volatile"
        if name.rpartition(".")[2] == "qos_profile_sensor_data":
            return "best_effort", "volatile"
        if isinstance(node, ast.Call) and _short(node.func) == "QoSProfile":
            options = {keyword.arg: keyword.value for keyword in node.keywords}
            set_later = {policy: self._values.get(f"{name}.{policy}") for policy in ("reliability", "durability")}
            options |= {policy: value for policy, value in set_later.items() if value is not None}
            given = {option: _dotted(value).rpartition(".")[2].lower() for option, value in options.items()}
            reliability = given.get("reliability", "reliable").removeprefix("rmw_qos_policy_reliability_")
            durability = given.get("durability", "volatile").removeprefix("rmw_qos_policy_durability_")
            return (
                reliability if reliability in ("reliable", "best_effort") else "",
                durability if durability in ("volatile", "transient_local") else "",
            )
        return "", ""


def _read_parameter(node: ast.expr | None) -> str:
    """Return the parameter x of ``self.get_parameter('x').value`` or ``.get_parameter_value().string_value``."""
    for part in ast.walk(node) if node is not None else ():
        if isinstance(part, ast.Call) and _short(part.func) in ("get_parameter", "declare_parameter") and part.args:
            name = part.args[0]
            return name.value if isinstance(name, ast.Constant) and isinstance(name.value, str) else ""
    return ""


def _is_self(arguments: list[ast.expr]) -> bool:
    return any(isinstance(argument, ast.Name) and argument.id == "self" for argument in arguments)


def _short(node: ast.expr) -> str:
    return _dotted(node).rpartition(".")[2]


def _dotted(node: ast.expr) -> str:
    """Return a name such as ``self.topic``; empty for other expressions."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        return f"{_dotted(node.value)}.{node.attr}"
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "super":
        return "super()"
    return ""
