"""Facts about the C++ classes of one package: the parameters that they declare, and their topics and services."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from check_launch.catalogue.facts import Parameter
from check_launch.expansion.source_trees import source_folders
from check_launch.extraction.cpp_expressions import Scope, declared_type, first_values
from check_launch.extraction.cpp_source import Call, CppSource
from check_launch.extraction.parameter_library import parameter_libraries
from check_launch.extraction.qos_profiles import qos_of
from roverlink import bounded_files

_SUFFIXES = (".cpp", ".hpp", ".h", ".cc")
_NO_NODES = ("test", "tests", "benchmark", "examples_tf2_py")
_DECLARING = {
    # function: position of the name and of the default among the arguments, if no node is the first one
    "declare_parameter": (0, 1),
    "declare_parameter_if_not_declared": (0, 1),
    "declare_or_get_parameter": (0, 1),
    "auto_declare": (0, 1),
    "declareParameter": (0, 1),
    "add_parameter": (0, 1),
    "setParam": (0, 1),
    "setParamT": (0, 1),
    "searchAndGetParam": (0, 1),
    "getParam": (1, 2),
    "getParentParam": (1, 2),
}
_ENDPOINTS = {
    "create_publisher": "publisher",
    "create_subscription": "subscription",
    "create_service": "service",
    "create_client": "client",
    "create_camera_publisher": "publisher",
    "create_camera_subscription": "subscription",
}
_READING = frozenset({"get_parameter", "get_parameter_or"})
_MAKING = frozenset({"make_unique", "make_shared"})
_NODE = re.compile(r"^(?:\*?this|&?\*?_?node_?|nh_?|parent_?|&\w+|\w*node\w*|shared_from_this\(\)|node_?->\w+\(\)|n)$")
_FILTER = re.compile(r"message_filters::Subscriber<\s*([\w:]+)")
_TYPE_BEFORE = re.compile(r"([\w:]+(?:<[\w:, ]+>)?)\s*(?:\*|>)?\s*$")
"""The type before a name that is declared."""
_VALUE = re.compile(
    r"(?:\w+(?:->|\.))?get_parameter\(\s*\"(?P<read>[\w.]+)\"\s*\)\s*\.as_bool\(\)|[A-Za-z_]\w*(?:(?:->|\.)\w+)*(?:\(\))?"
)
"""A value in a condition: a parameter that is read there, or a variable."""
_OF_LIBRARY = re.compile(r"(?:this->)?params?_?(?:->|\.)(?=\w)")
"""Beginning of a parameter of a library: ``params_.use_stamped_vel``."""
_MEMBER = re.compile(r"(?:_ptr<\s*|\b)((?:\w+::)*\w+)(?:<[^<>;]*>)?(?:\s*>)?\s+\w+\s*(?:;|\{[^{}]*\}\s*;)")
"""A declaration of an object. Each part begins with another character, as the spaces of a comment are many."""
_OPERATORS = {"&&": " and ", "||": " or ", "!": " not "}
_LONGEST_TYPE = 400  # characters
_NAMED = re.compile(r"\b(\w+)::\1\([^{};]*?\)\s*:\s*(?:\w+::)*\w+\(\s*\"(\w+)\"")
"""A constructor that gives a name to its base class, a node."""
_GIVEN = re.compile(r"[({,]\s*\*?(?:this|shared_from_this\(\)|weak_from_this\(\)|get_node\(\))\s*(?=[,)}])")
"""A node as an argument of a call."""
_HARMLESS = frozenset(
    {"TransformBroadcaster", "TransformListener", "StaticTransformBroadcaster", "MessageFilter", "Subscriber", "bind"}
    | {"create_server", "create_client", "create_timer", "create_publisher", "create_subscription", "subscribe"}
    | {"create_camera_publisher", "create_camera_subscription", "createTimerROS", "CreateTimerROS", "ImageTransport"}
    | {
        "spin",
        "spin_some",
        "add_node",
        "mem_fn",
        "ref",
        "static_cast",
        "dynamic_cast",
        "get_logger",
        "if",
        "ParamListener",
    }
    | {"create_service", "create_generic_subscription", "CameraInfoManager", "JointStateListener", "sizeof", "Rate"}
    | {"SyncParametersClient", "AsyncParametersClient"}
    | set(_DECLARING)
)
"""Functions and classes that declare no parameters of a node."""
_OPEN = re.compile(
    r"\b(?:automatically_declare_parameters_from_overrides|allow_undeclared_parameters)\s*\(\s*true"
    r"|\bdeclare_parameters\s*\("
)
"""Declarations of parameters whose names are in no literal of the source."""
NODE_CLASSES = frozenset({"LifecycleNode", "Node", "BaseNode"})
"""Base classes of nodes."""
DYNAMIC_TYPING = "dynamic_typing"
"""Field of a descriptor that lets a parameter change its type."""
LARGEST_SOURCE = 1 << 20
"""Bytes of the largest file of source code; larger ones are data."""
_LARGEST_PACKAGE = 3 << 20
"""Letters of C++ in a package that is read as a whole. A larger one contains libraries that know nothing of ROS."""
_PLACEHOLDER = re.compile(r"\{([^{}]*)\}")
_SCALAR = re.compile(r"^\{\w+\}$")


@dataclass(slots=True)
class ParameterFact:
    """A parameter that a class declares; the name is a pattern."""

    type: str
    default: Any
    stated: Parameter | None = None
    """The parameter as a library of parameters states it, with its range."""


@dataclass(frozen=True, slots=True)
class EndpointFact:
    """A topic, service or action of a class. ``$(x)`` in its name or QoS is the value of the parameter x."""

    kind: str
    name: str
    type: str
    reliability: str = ""
    durability: str = ""
    when: str = ""
    """Condition on parameters under which the class has it, as far as the sources say it (see `Endpoint.when`)."""


@dataclass(slots=True)
class ClassFacts:
    """Declarations of the functions of one class."""

    name: str
    bases: tuple[str, ...] = ()
    default_name: str = ""
    """Name that the constructor gives to the node; empty for other classes."""
    parts: dict[str, set[str]] = field(default_factory=dict)
    """Names of classes, as they are written, of which the class has objects, each with the topics that they get:
    texts, or ``$(x)`` for the value of the parameter x."""
    parameters: dict[str, ParameterFact] = field(default_factory=dict)
    endpoints: list[EndpointFact] = field(default_factory=list)
    is_partial: bool = False
    """True if the class may declare more, because it gives its node to code that was not read."""


def facts_of_package(folder: Path) -> dict[str, ClassFacts]:
    """Read the classes of the package in a folder, by their qualified names."""
    texts: dict[Path, str] = {}
    for path in _files(folder):
        with contextlib.suppress(OSError):  # a file that is not readable, or too large to be source code
            texts[path] = bounded_files.read(path, LARGEST_SOURCE).decode(errors="replace")
    if sum(map(len, texts.values())) > _LARGEST_PACKAGE:
        texts = {path: text for path, text in texts.items() if "rclcpp" in text}
    sources = {path: CppSource(text) for path, text in texts.items()}
    return _PackageReader(sources, parameter_libraries(folder)).read()


def _files(folder: Path) -> Iterator[Path]:
    for inner, _, names in source_folders(folder):
        if not set(inner.relative_to(folder).parts) & set(_NO_NODES):
            yield from (inner / name for name in names if name.endswith(_SUFFIXES) and (inner / name).is_file())


class _PackageReader:
    def __init__(self, sources: Mapping[Path, CppSource], libraries: Mapping[str, Mapping[str, Parameter]]) -> None:
        self._sources, self._libraries = sources, libraries
        self._classes: dict[str, ClassFacts] = {}
        self._names: set[str] = set()
        self._aliases: dict[str, str] = {}
        self._texts: dict[str, list[str]] = {}
        self._all = [source.text for source in sources.values()]
        self._links: dict[str, dict[str, str]] = {}

    def read(self) -> dict[str, ClassFacts]:
        for source in self._sources.values():
            for declared in source.classes:
                known = self._classes.setdefault(declared.name, ClassFacts(declared.name, declared.bases))
                known.bases = known.bases or declared.bases
            self._aliases |= {alias.rpartition("::")[2]: meaning for alias, meaning in source.aliases}
        self._names = {declared.name for source in self._sources.values() for declared in source.classes}
        self._note_aliases()
        filters = {alias for alias, meaning in self._aliases.items() if _FILTER.search(meaning)}
        names = frozenset({*_DECLARING, *_ENDPOINTS, *_READING, *_MAKING, *filters, "subscribe", "create_server"})
        calls = [
            (source, replace(call, owner=self._declared(call.owner)))
            for source in self._sources.values()
            for call in source.calls(names)
        ]
        for source, call in calls:
            self._note_reading(source, call)
        for source, call in calls:
            self._note(source, call)
        for source in self._sources.values():
            self._note_members(source)
            self._note_library(source)
            self._note_given(source)
            for match in _NAMED.finditer(source.text):
                if owner := self._declared(source.owner(match.end())):
                    facts = self._facts(owner)
                    facts.default_name = facts.default_name or match[2]
        return {name: facts for name, facts in self._classes.items() if name}

    def _note_aliases(self) -> None:
        """Give another name of a class in a namespace all that the class has, as if it were derived from it."""
        known = {*(name.rpartition("::")[2] for name in self._names), *NODE_CLASSES}
        for alias, meaning in (pair for source in self._sources.values() for pair in source.aliases):
            original = re.sub(r"<.*", "", meaning).strip()
            scope, _, short = alias.rpartition("::")
            if scope not in self._names and original.rpartition("::")[2] in known - {short}:
                self._classes.setdefault(alias, ClassFacts(alias, (original,)))

    def _declared(self, owner: str) -> str:
        """Return the full name of a class; a .cpp file may leave the namespace out (`using namespace`)."""
        if owner and owner not in self._names:
            fitting = [name for name in self._names if name.endswith(f"::{owner}")]
            return fitting[0] if len(fitting) == 1 else owner
        return owner

    def _facts(self, owner: str) -> ClassFacts:
        return self._classes.setdefault(owner, ClassFacts(owner))

    def _scope(self, source: CppSource, call: Call) -> Scope:
        texts = self._texts_of(call.owner, source)
        everywhere = [*texts, *self._all]
        return Scope(
            source,
            call.position,
            lambda name: first_values(everywhere if name.isupper() else texts, name),
            lambda name: declared_type(everywhere if name.isupper() else texts, name),
        )

    def _texts_of(self, owner: str, source: CppSource) -> list[str]:
        """Return the texts of the files that declare a class or one of its base classes, the nearest first."""
        if owner not in self._texts:
            short, texts = owner.rpartition("::")[2], [source.text]
            wanted = {owner, *(base for base in self._facts(owner).bases)} if owner else set()
            for other in self._sources.values():
                names = {declared.name for declared in other.classes}
                if other.text is not source.text and (
                    names & wanted or any(name.rpartition("::")[2] in (short, *wanted) for name in names)
                ):
                    texts.append(other.text)
            self._texts[owner] = texts
        texts = self._texts[owner]
        return texts if source.text in texts else [source.text, *texts]

    def _note_reading(self, source: CppSource, call: Call) -> None:
        """Remember which variable gets the value of which parameter."""
        links = self._links.setdefault(call.owner, {})
        arguments = _without_node(call.arguments)
        if call.function not in (_READING | _DECLARING.keys()) or not arguments:
            return
        position = _DECLARING.get(call.function, (0, 1))[0]
        if len(arguments) <= position:
            return
        name = self._scope(source, call).pattern(arguments[position])
        if call.function in _READING and len(arguments) > 1 and re.fullmatch(r"[\w.>-]+", arguments[1]):
            links.setdefault(arguments[1].removeprefix("this->"), name)
        if call.function in ("setParamT",) and len(arguments) > 1:
            links.setdefault(arguments[1], name)
        before = source.text[max(0, call.position - 200) : call.position]
        if assigned := re.search(r"(?:^|[;{}\n]|\b[\w:]+\s)\s*(\w+)\s*=\s*(?:\([^()]*\)\s*)?[\w>.:\s()*-]*$", before):
            links.setdefault(assigned[1], name)

    def _linked(self, owner: str, variable: str, source: CppSource, depth: int = 0) -> str:
        """Return the parameter whose value a variable of a class has; empty if it has none."""
        name = variable.removeprefix("this->").removesuffix("()").replace("options_.", "")
        owners = [owner, *(full for full in self._classes if full.rpartition("::")[2] in self._bases_of(owner))]
        for class_name in owners:
            links = self._links.get(class_name, {})
            for spelling in (name, f"{name}_"):
                if spelling in links:
                    return links[spelling]
        if depth < 3:
            for text in (text for text in self._texts_of(owner, source) if name in text):
                pattern = (
                    rf"\b{re.escape(name)}_?\s*=\s*\([\w:]+\)\s*(?P<cast>\w+)\s*;"
                    rf"|\b{re.escape(name)}\s*=\s*(?P<library>{_OF_LIBRARY.pattern})?(?P<other>[\w.]+)\s*;"
                )
                for match in re.finditer(pattern, text):
                    if match["library"]:
                        return match["other"]
                    other = match["cast"] or match["other"]
                    if other != name and (found := self._linked(owner, other, source, depth + 1)):
                        return found
        return ""

    def _when(self, source: CppSource, call: Call) -> str:
        """Return the condition on parameters under which a call is reached, as far as it is known."""
        known: list[str] = []
        for written, is_true in source.conditions(call.position):
            parts = written.split("&&") if is_true and "||" not in written else [written]
            texts = [text for part in parts if (text := self._condition(part, source, call))]
            known += [text if is_true else f"not ({text})" for text in texts]
        return " and ".join(dict.fromkeys(known))

    def _condition(self, written: str, source: CppSource, call: Call) -> str:
        """Return a condition of C++ with ``$(x)`` for the parameter x; empty if it is about anything else."""
        rest = _VALUE.sub("", written)
        for text in _OPERATORS:
            rest = rest.replace(text, " ")
        if rest.strip(" ()") or rest.count("(") != rest.count(")"):
            return ""

        def replaced(match: re.Match[str]) -> str:
            library = _OF_LIBRARY.match(match[0])
            name = match["read"] or (
                match[0][library.end() :] if library else self._linked(call.owner, match[0], source)
            )
            unknown.append(not name)
            return f"$({name})"

        unknown: list[bool] = []
        text = _VALUE.sub(replaced, written)
        for operator, word in _OPERATORS.items():
            text = text.replace(operator, word)
        text = " ".join(text.split())
        return "" if any(unknown) else f"({text})" if " or " in text else text

    def _bases_of(self, owner: str) -> set[str]:
        facts = self._classes.get(owner)
        return {base.rpartition("::")[2] for base in facts.bases} if facts else set()

    def _note(self, source: CppSource, call: Call) -> None:
        arguments = list(_without_node(call.arguments))
        if call.function in _DECLARING:
            self._note_parameter(source, call, arguments)
        elif (
            call.function in _ENDPOINTS and arguments and (call.template or "image_transport" in _before(source, call))
        ):
            kind = _ENDPOINTS[call.function]
            type_ = call.template or "sensor_msgs::msg::Image"
            if call.function == "create_client" and "rclcpp_action" in _before(source, call):
                kind, arguments = "action_client", [argument for argument in arguments if '"' in argument][:1]
            self._note_endpoint(source, call, kind, type_, arguments)
            if "camera" in call.function:
                self._note_camera_info(call.owner)
        elif call.function == "subscribe" and len(call.arguments) > 1 and arguments:
            type_ = self._filtered_type(source, call)
            if type_:
                qos = [argument for argument in arguments[1:] if "QOS" in argument.upper()]
                self._note_endpoint(source, call, "subscription", type_, [arguments[0], *(qos or arguments[1:])])
        elif call.function in _MAKING and call.template:
            self._note_made(source, call, arguments)
        elif call.function in self._aliases and arguments and "new " in _before(source, call):
            match = _FILTER.search(self._aliases[call.function])
            if match:
                self._note_endpoint(source, call, "subscription", match[1], arguments)

    def _note_made(self, source: CppSource, call: Call, arguments: list[str]) -> None:
        made = self._meaning(call.template)
        if match := _FILTER.search(made):
            self._note_endpoint(source, call, "subscription", match[1], arguments)
        elif "ActionServer" in made and (names := [argument for argument in arguments if argument.startswith('"')]):
            action = re.search(r"<\s*([\w:]+)", made)
            self._note_endpoint(source, call, "action", self._meaning(action[1]) if action else "", names[:1])
        elif call.owner:
            parts = self._facts(call.owner).parts.setdefault(re.sub(r"<.*", "", call.template).strip(), set())
            scope = self._scope(source, call)
            given = [self._with_parameters(scope.pattern(argument), call.owner, source) for argument in arguments]
            texts = [text for text, written in zip(given, arguments, strict=True) if '"' in written and "{" not in text]
            parts.update((texts or [text for text in given if re.fullmatch(r"\$\(\w*topic\w*\)", text)])[:1])

    def _filtered_type(self, source: CppSource, call: Call) -> str:
        """Return the message type of a message filter; empty if the receiver is none."""
        if "getTransport" in " ".join(call.arguments) or "image_transport" in " ".join(call.arguments):
            return "sensor_msgs::msg::Image"
        for text in self._texts_of(call.owner, source):
            names = re.finditer(rf"{re.escape(call.receiver)}\s*;", text)
            before = (_TYPE_BEFORE.search(text, max(0, name.start() - _LONGEST_TYPE), name.start()) for name in names)
            declared = next(filter(None, before), None)
            if declared and (match := _FILTER.search(self._meaning(declared[1]))):
                return match[1]
            if declared and "SubscriberFilter" in declared[1]:
                return "sensor_msgs::msg::Image"
        return ""

    def _note_parameter(self, source: CppSource, call: Call, arguments: list[str]) -> None:
        at, default_at = _DECLARING[call.function]
        if len(arguments) <= at:
            return
        scope = self._scope(source, call)
        if items := _items(arguments[at], arguments[default_at : default_at + 1], scope):
            self._facts(call.owner).parameters.update(items)
            return
        name = scope.pattern(arguments[at])
        if call.function == "declareParameter":  # of layers of a costmap, whose parameters begin with the layer's name
            name = f"{{name_}}.{name}"
        if call.function in ("getParam", "getParentParam") and (prefix := _getter(source, call)):
            begin = scope.pattern(prefix)
            name = f"{begin}.{name}" if begin else name
        if not _PLACEHOLDER.sub("", name).strip(".") and not _SCALAR.match(name):
            return
        given = arguments[default_at] if len(arguments) > default_at else ""
        type_, default = scope.value(given) if given else ("", None)
        if call.template:
            written, _ = scope.value(f"std::vector<{call.template}>()")
            type_ = written.removesuffix("_array") or type_
            default = float(default) if type_ == "double" and type(default) is int else default
        if DYNAMIC_TYPING in source.text:
            type_ = ""
        known = self._facts(call.owner).parameters
        before = known.get(name)
        known[name] = (
            ParameterFact(before.type, before.default) if before and before.type else ParameterFact(type_, default)
        )

    def _note_endpoint(self, source: CppSource, call: Call, kind: str, type_: str, arguments: list[str]) -> None:
        if not arguments:
            return
        scope = self._scope(source, call)
        name = self._with_parameters(scope.pattern(arguments[0]), call.owner, source)
        qos = arguments[1] if len(arguments) > 1 and kind in ("publisher", "subscription") else ""
        reliability, durability = qos_of(
            qos,
            scope,
            lambda variable: self._linked(call.owner, variable, source),
            kind in ("publisher", "subscription"),
        )
        when = self._when(source, call)
        fact = EndpointFact(kind, name, _ros_type(self._meaning(type_)), reliability, durability, when)
        endpoints = self._facts(call.owner).endpoints
        if fact not in endpoints:
            endpoints.append(fact)

    def _note_camera_info(self, owner: str) -> None:
        """Add the topic camera_info beside the topic of images that was noted last (image_transport)."""
        facts = self._facts(owner)
        image = facts.endpoints[-1]
        facts.is_partial |= "$(" in image.name
        folder, slash, _ = image.name.rpartition("/")
        facts.endpoints.append(replace(image, name=f"{folder}{slash}camera_info", type="sensor_msgs/msg/CameraInfo"))

    def _with_parameters(self, pattern: str, owner: str, source: CppSource) -> str:
        def replaced(match: re.Match[str]) -> str:
            parameter = self._linked(owner, match[1], source)
            return f"$({parameter})" if parameter else match[0]

        return _PLACEHOLDER.sub(replaced, pattern)

    def _meaning(self, type_: str) -> str:
        for _ in range(3):
            if type_.strip() not in self._aliases:
                break
            type_ = self._aliases[type_.strip()]
        return type_.strip()

    def _note_members(self, source: CppSource) -> None:
        """Remember of which classes a class has objects: a controller server has a subscriber of odometry."""
        short = {name.rpartition("::")[2] for name in self._classes}
        for match in _MEMBER.finditer(source.text):
            owner = self._declared(source.owner(match.start()))
            if owner and match[1].rpartition("::")[2] in short:
                self._facts(owner).parts.setdefault(match[1], set())

    def _note_library(self, source: CppSource) -> None:
        """Give the parameters of a library to the class that has its `ParamListener`."""
        for match in re.finditer(r"\bParamListener\b", source.text) if "ParamListener" in source.text else ():
            owner = self._declared(source.owner(match.start()))
            included = [
                name for name in self._libraries if re.search(rf"[/\"<]{re.escape(name)}\.hpp[\">]", source.text)
            ]
            for name in included if owner else ():
                for key, parameter in self._libraries[name].items():
                    self._facts(owner).parameters.setdefault(
                        key, ParameterFact(parameter.type, parameter.default, parameter)
                    )

    def _note_given(self, source: CppSource) -> None:
        """Mark classes that give their node to a function that was not read, which may declare more."""
        for match in _GIVEN.finditer(source.text):
            owner = self._declared(source.owner(match.start()))
            if owner and (function := _called_with(source.text, match.start())) and function not in _HARMLESS:
                is_read = any(name.rpartition("::")[2] == function for name in self._classes)
                self._facts(owner).is_partial |= not is_read
        for match in _OPEN.finditer(source.text):
            if owner := self._declared(source.owner(match.start())):
                self._facts(owner).is_partial = True


def _called_with(text: str, position: int) -> str:
    """Return the name of the function of which an argument stands at a position; empty if there is none."""
    depth = 0
    for index in range(position, max(0, position - 500), -1):
        depth += (text[index] in ")]}") - (text[index] in "([{")
        if depth < 0:
            found = re.search(r"(\w+)\s*(?:<([^;{}()]*)>)?\s*$", text[max(0, index - 200) : index])
            if found and found[1] in _MAKING and found[2]:
                return re.sub(r"<.*", "", found[2]).strip().rpartition("::")[2]
            return found[1] if found else ""
    return ""


def _items(name: str, default: list[str], scope: Scope) -> dict[str, ParameterFact]:
    """Return the parameters that a loop declares for each of a node's own default plugins: ``ids[i] + ".plugin"``."""
    ids = re.match(r"(\w+)\[\w+\]\s*\+\s*\"([^\"]*)\"$", name)
    types = re.search(r"(\w+)\[\w+\]", default[0]) if default else None
    if not ids or not types:
        return {}
    names, values = scope.value(ids[1])[1], scope.value(types[1])[1]
    if not isinstance(names, list) or not isinstance(values, list):
        return {}
    return {f"{name}{ids[2]}": ParameterFact("string", value) for name, value in zip(names, values, strict=False)}


def _without_node(arguments: Iterable[str]) -> tuple[str, ...]:
    arguments = tuple(arguments)
    return arguments[1:] if len(arguments) > 1 and _NODE.match(arguments[0]) else arguments


def _before(source: CppSource, call: Call) -> str:
    return source.text[max(0, call.position - 40) : call.position]


def _getter(source: CppSource, call: Call) -> str:
    """Return the prefix of the parameters that a function of Nav2's MPPI controller reads (`getParamGetter`)."""
    text = source.text[source.function_start(call.position) : call.position]
    found = re.findall(rf"\b{call.function}\s*=\s*[\w>.-]+getParamGetter\(([^;]*)\);", text)
    return found[-1] if found else ""


def _ros_type(type_: str) -> str:
    parts = [part for part in re.sub(r"<.*", "", type_).split("::") if part]
    return "/".join(parts) if len(parts) == 3 else ""
