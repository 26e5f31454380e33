"""Actions of YAML and XML launch files."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from check_launch.expansion.actions import (
    Action,
    DeclareArgument,
    Execute,
    GivenFile,
    GivenParameter,
    Group,
    Include,
    Later,
    LoadNodes,
    PushNamespace,
    Remapping,
    SetConfiguration,
    SetEnvironment,
    SetParameter,
    SetParametersFromFile,
    SetRemap,
    StartNode,
)
from check_launch.expansion.entities import Attribute, Entity, read_entities
from check_launch.expansion.substitutions import TextSubstitution, UnknownSubstitution
from check_launch.expansion.written_text import WrongTextError, parse_text
from check_launch.misspellings import did_you_mean, nearest
from check_launch.rules.launch_rules import UnknownAction, as_hint
from roverlink.generator.diagnostics import Diagnostic, Span

_OF_ALL = frozenset({"if", "unless"})
_OF_PROCESS = frozenset(
    {"output", "respawn", "respawn_delay", "respawn_max_retries", "launch-prefix", "cwd", "shell", "sigterm_timeout"}
    | {"sigkill_timeout", "emulate_tty", "on_exit"}
)
_OF_NODE = _OF_PROCESS | {"pkg", "exec", "exec_name", "name", "namespace", "args", "ros_args"}
_ATTRIBUTES: Mapping[str, frozenset[str]] = {
    "arg": frozenset({"name", "default", "description"}),
    "let": frozenset({"name", "value"}),
    "set_env": frozenset({"name", "value"}),
    "append_env": frozenset({"name", "value", "prepend", "separator"}),
    "unset_env": frozenset({"name"}),
    "reset_env": frozenset(),
    "reset": frozenset(),
    "group": frozenset({"scoped", "forwarding"}),
    "include": frozenset({"file"}),
    "push_ros_namespace": frozenset({"namespace"}),
    "push-ros-namespace": frozenset({"namespace"}),
    "set_remap": frozenset({"from", "to"}),
    "set_parameter": frozenset({"name", "value"}),
    "set_parameters_from_file": frozenset({"filename"}),
    "set_use_sim_time": frozenset({"value"}),
    "node": _OF_NODE,
    "node_container": _OF_NODE,
    "composable_node": frozenset({"pkg", "plugin", "name", "namespace"}),
    "load_composable_node": frozenset({"target"}),
    "executable": _OF_PROCESS | {"cmd", "name"},
    "log": frozenset({"message", "level"}),
    "log_info": frozenset({"message"}),
    "shutdown": frozenset({"reason"}),
    "timer": frozenset({"period"}),
    "ros_timer": frozenset({"period"}),
    "param": frozenset({"name", "value", "from", "type", "sep", "allow_substs", "value-sep"}),
    "remap": frozenset({"from", "to"}),
    "env": frozenset({"name", "value"}),
    "keep": frozenset({"name", "value"}),
    "choice": frozenset({"value"}),
    "extra_arg": frozenset({"name", "value"}),
}
"""Attributes of each element (launch and launch_ros of humble and jazzy)."""
_NEEDED: Mapping[str, tuple[str, ...]] = {
    "arg": ("name",),
    "let": ("name", "value"),
    "set_env": ("name", "value"),
    "include": ("file",),
    "push_ros_namespace": ("namespace",),
    "set_remap": ("from", "to"),
    "set_parameter": ("name", "value"),
    "node": ("exec",),
    "node_container": ("exec", "name", "namespace"),
    "composable_node": ("pkg", "plugin"),
    "load_composable_node": ("target",),
    "executable": ("cmd",),
}
"""Attributes without which `ros2 launch` refuses an element."""
_CHILDREN: Mapping[str, frozenset[str]] = {
    "arg": frozenset({"choice"}),
    "include": frozenset({"arg", "let"}),
    "node": frozenset({"param", "remap", "env"}),
    "node_container": frozenset({"param", "remap", "env", "composable_node"}),
    "composable_node": frozenset({"param", "remap", "extra_arg"}),
    "load_composable_node": frozenset({"composable_node"}),
    "executable": frozenset({"env"}),
}
"""Elements in each element that contains no actions."""
_FOR_ALL: Mapping[str, str] = {"param": "set_parameter", "remap": "set_remap", "env": "set_env", "rosparam": "param"}
"""Actions that do for all nodes what an element does in one node, or did in ROS 1."""
_OF_BOTH = frozenset({"arg", "env", "group", "include", "node", "param", "remap"})
"""Elements that ROS 1 has, too."""
_ROS1_ELEMENTS = frozenset({"rosparam", "machine", "test"})
_ROS1_ATTRIBUTES: Mapping[str, frozenset[str]] = {
    "arg": frozenset({"doc"}),
    "group": frozenset({"ns", "clear_params"}),
    "include": frozenset({"ns", "clear_params", "pass_all_args"}),
    "node": frozenset({"type", "machine", "required", "clear_params"}),
    "param": frozenset({"command", "textfile", "binfile"}),
}
"""Attributes that ROS 1 alone has (http://wiki.ros.org/roslaunch/XML)."""
_ROS1_TEXT = re.compile(r"\$\((?:arg|find)\s|\$\(eval\s.*\barg\(")
_ROS2_TEXT = re.compile(r"\$\((?:var|dirname|find-pkg-\w+|find-exec|exec-in-\w+)\b")


class OfRos1Error(Exception):
    """Raised for a launch file that only ROS 1 reads; has the place that tells, and its text as the message."""

    def __init__(self, place: Span, message: str) -> None:
        super().__init__(message)
        self.place = place


def read_declarative(path: Path, shown: str) -> tuple[list[Action], list[Diagnostic]]:
    """Read the actions of a YAML or XML launch file, and what is wrong in it.

    Raises `UnreadableFileError` or `OfRos1Error`.
    """
    entities = read_entities(path, shown)
    inside = list(_all_of(entities))
    signs = [sign for entity in inside for sign in _signs_of_ros1(entity)]
    signs += [
        (child.place, "<param> outside of <node>")
        for children in (entities, *(entity.children for entity in inside if entity.name not in _CHILDREN))
        for child in children
        if child.name == "param"
    ]
    if path.suffix not in (".yaml", ".yml") and len(signs) > sum(map(_is_of_ros2, inside)):
        raise OfRos1Error(*signs[0])
    reader = _Reader()
    return reader.actions(entities), reader.findings


def _all_of(entities: Iterable[Entity]) -> Iterator[Entity]:
    for entity in entities:
        yield entity
        yield from _all_of(entity.children)


def _signs_of_ros1(entity: Entity) -> Iterator[tuple[Span, str]]:
    """Yield places and texts that ROS 1 reads and ROS 2 refuses."""
    if entity.name in _ROS1_ELEMENTS:
        yield entity.place, f"<{entity.name}>"
    for name, attribute in entity.attributes.items():
        if name in _ROS1_ATTRIBUTES.get(entity.name, ()):
            yield attribute.place, f"<{entity.name} {name}=...>"
        if found := _ROS1_TEXT.search(str(attribute.value)):
            yield attribute.place, f"{found[0].split()[0]} ...)"


def _is_of_ros2(entity: Entity) -> bool:
    """Return true for an element that ROS 1 refuses."""
    is_new = entity.name in _ATTRIBUTES and entity.name not in _OF_BOTH
    texts = (str(attribute.value) for attribute in entity.attributes.values())
    return is_new or "exec" in entity.attributes or any(map(_ROS2_TEXT.search, texts))


class _Reader:
    def __init__(self) -> None:
        self.findings: list[Diagnostic] = []

    def actions(self, entities: list[Entity]) -> list[Action]:
        found: list[Action] = []
        for entity in entities:
            self._check_attributes(entity)
            if make := _MAKERS.get(entity.name):
                action = make(self, entity)
                if action is not None:
                    action.condition = self._condition(entity)
                    found.append(action)
            elif entity.name not in _ATTRIBUTES or entity.name in _FOR_ALL:
                help = did_you_mean(_FOR_ALL.get(entity.name) or nearest(entity.name, _MAKERS))
                finding = UnknownAction.at(entity.place, f"unknown action '{entity.name}'", help)
                # Packages can add actions (launch/frontend/expose.py).
                self.findings.append(finding if help or entity.name in _ROS1_ELEMENTS else as_hint(finding))
        return found

    def _check_attributes(self, entity: Entity) -> None:
        known = _ATTRIBUTES.get(entity.name)
        if known is None:
            return
        known |= _OF_ALL
        for name, attribute in entity.attributes.items():
            if name not in known:
                message = f"'{entity.name}' has no attribute '{name}'"
                self.findings.append(
                    UnknownAction.at(attribute.key, message, did_you_mean(nearest(name, sorted(known))))
                )
        for name in _NEEDED.get(entity.name, ()):
            if name not in entity.attributes:
                self.findings.append(UnknownAction.at(entity.place, f"'{entity.name}' has no '{name}', which it needs"))
        children = _CHILDREN.get(entity.name)
        for child in entity.children:
            if children is not None and child.name not in children:
                message = f"'{entity.name}' can have no '{child.name}'"
                help = did_you_mean(nearest(child.name, sorted(children)))
                self.findings.append(UnknownAction.at(child.place, message, help))
            if child.name in ("param", "remap", "env", "keep", "choice", "extra_arg"):
                self._check_attributes(child)

    def _text(self, attribute: Attribute | None) -> Any:
        if attribute is None:
            return None
        return self._parsed(attribute.value, attribute.place)

    def _parsed(self, value: Any, place: Span) -> Any:
        if isinstance(value, bool):
            return str(value).lower()
        if not isinstance(value, str):
            return "" if value is None else str(value)
        try:
            return parse_text(value)
        except WrongTextError as error:
            self.findings.append(UnknownAction.at(place, str(error)))
            return UnknownSubstitution()

    def get(self, entity: Entity, name: str) -> Any:
        """Return the text of an attribute; None if the element has none."""
        return self._text(entity.attributes.get(name))

    def _condition(self, entity: Entity) -> tuple[bool, Any] | None:
        for name in ("if", "unless"):
            if name in entity.attributes:
                return name == "if", self.get(entity, name)
        return None

    def argument(self, entity: Entity) -> Action:
        choices = [str(child.attributes["value"].value) for child in entity.children if "value" in child.attributes]
        return DeclareArgument(
            entity.place,
            None,
            self.get(entity, "name") or "",
            self.get(entity, "default"),
            tuple(choices),
            str(entity.attributes["description"].value) if "description" in entity.attributes else "",
        )

    def include(self, entity: Entity) -> Action:
        arguments = [
            (self.get(child, "name"), self.get(child, "value"), child.attributes["name"].place)
            for child in entity.children
            if child.name in ("arg", "let") and "name" in child.attributes
        ]
        return Include(entity.place, None, self.get(entity, "file") or "", arguments)

    def group(self, entity: Entity) -> Action:
        scoped = entity.attributes.get("scoped")
        return Group(
            entity.place, None, self.actions(entity.children), str(scoped.value).lower() != "false" if scoped else True
        )

    def node(self, entity: Entity) -> StartNode:
        return StartNode(
            entity.place,
            None,
            self.get(entity, "pkg") or "",
            self.get(entity, "exec") or "",
            self.get(entity, "plugin") or "",
            self.get(entity, "name"),
            self.get(entity, "namespace"),
            self._parameters(entity),
            [remapping for child in entity.children if child.name == "remap" for remapping in self._remapping(child)],
            self._words(entity, "args"),
            self._words(entity, "ros_args"),
        )

    def _words(self, entity: Entity, name: str) -> list[Any]:
        """Split arguments at spaces; a word may have several parts, such as ``topic:$(var camera)``."""
        text = self.get(entity, name)
        if text is None:
            return []
        words: list[Any] = []
        open_word = False
        for part in text if isinstance(text, list) else [text]:
            if not isinstance(part, str):
                words[-1:] = [[*words[-1], part]] if open_word else [*words[-1:], [part]]
                open_word = True
                continue
            pieces = _split(part)
            if pieces and open_word and not part[0].isspace():
                words[-1].append(pieces.pop(0))
            words += [[piece] for piece in pieces]
            open_word = bool(part) and not part[-1].isspace()
        return words

    def _remapping(self, entity: Entity) -> list[Remapping]:
        source, target = entity.attributes.get("from"), entity.attributes.get("to")
        if source is None or target is None:
            self.findings.append(UnknownAction.at(entity.place, "a 'remap' needs 'from' and 'to'"))
            return []
        return [Remapping(self._text(source), self._text(target), source.place, target.place)]

    def _parameters(self, entity: Entity) -> list[GivenParameter | GivenFile]:
        found: list[GivenParameter | GivenFile] = []
        for child in entity.children:
            if child.name != "param":
                continue
            if source := child.attributes.get("from"):
                substitutes = child.attributes.get("allow_substs")
                has_substitutions = substitutes is not None and str(substitutes.value).lower() == "true"
                found.append(GivenFile(self._text(source), source.place, has_substitutions))
            elif name := child.attributes.get("name"):
                value, is_text = self._parameter_value(child)
                found.append(GivenParameter(self._text(name), value, name.place, is_text))
            else:
                self.findings.append(UnknownAction.at(child.place, "a 'param' needs 'name' or 'from'"))
        return found

    def _parameter_value(self, entity: Entity) -> tuple[Any, bool]:
        value, type_ = entity.attributes.get("value"), entity.attributes.get("type")
        if value is None:
            return {
                str(child.attributes["name"].value): self._parameter_value(child)[0]
                for child in entity.children
                if child.name == "param" and "name" in child.attributes
            }, False
        is_text = type_ is not None and str(type_.value) == "str"
        if isinstance(value.value, str):
            parsed = self._text(value)
            return parsed if isinstance(parsed, list) else TextSubstitution(text=parsed), is_text
        return value.value, is_text

    def container(self, entity: Entity) -> Action:
        nodes = [self.node(child) for child in entity.children if child.name == "composable_node"]
        for child in entity.children:
            if child.name == "composable_node":
                self._check_attributes(child)
        own = self.node(entity) if entity.name == "node_container" else None
        if own:
            own.condition = None
        return LoadNodes(entity.place, None, own, nodes)

    def executable(self, entity: Entity) -> Action:
        return Execute(entity.place, None, self._words(entity, "cmd"))


def _split(text: str) -> list[str]:
    try:
        return shlex.split(text)
    except ValueError:  # a quotation mark that a substitution closes
        return text.split()


Maker = Callable[[_Reader, Entity], Action | None]
"""Function that returns the action of an element."""


def _of_texts(action: Callable[..., Action], *attributes: str) -> Maker:
    """Return a maker of an action whose fields are the texts of attributes; a missing one is empty."""
    return lambda reader, entity: action(
        entity.place, None, *(reader.get(entity, attribute) or "" for attribute in attributes)
    )


_MAKERS: Mapping[str, Maker] = {
    "arg": _Reader.argument,
    "let": _of_texts(SetConfiguration, "name", "value"),
    "set_env": _of_texts(SetEnvironment, "name", "value"),
    "group": _Reader.group,
    "include": _Reader.include,
    "push_ros_namespace": _of_texts(PushNamespace, "namespace"),
    "push-ros-namespace": _of_texts(PushNamespace, "namespace"),
    "set_remap": _of_texts(SetRemap, "from", "to"),
    "set_parameter": lambda reader, entity: SetParameter(
        entity.place, None, reader.get(entity, "name") or "", reader._parameter_value(entity)[0]
    ),
    "set_use_sim_time": lambda reader, entity: SetParameter(
        entity.place, None, "use_sim_time", [reader.get(entity, "value")]
    ),
    "set_parameters_from_file": _of_texts(SetParametersFromFile, "filename"),
    "node": _Reader.node,
    "node_container": _Reader.container,
    "load_composable_node": _Reader.container,
    "executable": _Reader.executable,
    "timer": lambda reader, entity: Later(entity.place, None, reader.actions(entity.children)),
    "ros_timer": lambda reader, entity: Later(entity.place, None, reader.actions(entity.children)),
}
