"""Command line of a ROS 2 node: the arguments after ``--ros-args``.

As in rcl, these are ``-p name:=value``, ``--params-file FILE``, ``-r from:=to`` (also with ``__ns`` and ``__node``) and
``--log-level``. They end at ``--`` or at the end of the command line. ``--disable-stdout-logs`` turns off the log on
the console, and ``--disable-rosout-logs`` the log on the topic ``/rosout``. Switches for features that this node does
not have are accepted and have no effect. A remap or a parameter may begin with the name of the node for which it is
meant (``node:name:=value``).
"""

from __future__ import annotations

import logging
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from roverlink.bounded_files import read_text
from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.middleware import NodeIdentity
from roverlink.runtime.text import strict_yaml

LOG_LEVELS = ("debug", "info", "warn", "error", "fatal")
_NODE_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_NAMESPACE = re.compile(r"/|(/[A-Za-z_][A-Za-z0-9_]*)+")
_TOPIC = re.compile(r"(~/|/)?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")
_LEFT_SIDE = re.compile(
    r"((?P<node>\w+):(?!//))?(?P<name>.+)"
)  # the colon of rostopic://topic does not separate a node's name


@dataclass(slots=True)
class RosArguments:
    """Contents of the arguments after ``--ros-args``, as far as they are meant for one node."""

    node: NodeIdentity
    parameters: dict[str, Any] = field(default_factory=dict)
    shared_parameters: set[str] = field(default_factory=set)
    """Names of the parameters that only a section for several nodes of a parameter file sets, such as ``/**``."""
    unaddressed_parameters: set[str] = field(default_factory=set)
    """Names of the parameters that ``-p`` sets without the name of a node."""
    log_level: str = "info"
    logs_to_console: bool = True
    logs_to_rosout: bool = True
    remaps: list[tuple[str, str]] = field(default_factory=list)
    """Pairs of names: the topic with the first one gets the second one."""

    def parameters_in(self, declared: Collection[str], logger: logging.Logger) -> dict[str, Any]:
        """Return the parameters without those that are for several nodes, and that this node does not declare.

        As in ROS 2, such a parameter belongs to another node. It is logged with the level debug, or as a warning if its
        name looks like a misspelt name of this node.

        SetParameter of a launch file gives each of its nodes a ``-p`` without a node's name. Such a parameter is also
        left out, with a warning, unless its name looks misspelt: then it was typed for this node.
        """
        values = dict(self.parameters)
        for name in sorted((self.shared_parameters | self.unaddressed_parameters).difference(declared)):
            hint, typed = nearest(name, declared, ""), name in self.unaddressed_parameters
            if typed and hint:
                continue
            del values[name]
            source = "this node does not have" if typed else "a parameter file sets for several nodes"
            text = f"ignored the parameter {name!r}, which {source}"
            logger.log(logging.WARNING if typed or hint else logging.DEBUG, "%s", f"{text}; {hint}" if hint else text)
        return values

    def topic(self, name: str) -> str:
        """Return the fully qualified name of a topic after remapping. As in rcl, the first matching rule decides."""
        full = self.node.topic(name)
        for source, target in self.remaps:
            if self.node.topic(source) == full:
                return self.node.topic(target)
        return full


def is_topic(name: str) -> bool:
    """Return true if a text can be the name of a topic, such as ``imu``, ``~/imu`` or ``/rover/imu``."""
    return bool(_TOPIC.fullmatch(name))


def split(arguments: list[str]) -> tuple[list[str], list[str]]:
    """Split a command line into two lists: the program's own arguments, and those between ``--ros-args`` and ``--``."""
    own: list[str] = []
    ros: list[str] = []
    target = own
    for argument in arguments:
        if argument == "--ros-args":
            target = ros
        elif argument == "--" and target is ros:
            target = own
        else:
            target.append(argument)
    return own, ros


def parse(arguments: list[str], default_name: str) -> RosArguments:
    """Read the arguments after ``--ros-args``. Raises `SetupError` that quotes a wrong argument.

    ``default_name`` is the node's name if no argument sets it.
    """
    options = list(_options(arguments))
    parsed = RosArguments(_identity(options, default_name))
    for option, value in options:
        if option == "params-file":
            for pattern, found in _read_params_file(Path(value), parsed.node):
                _set_parameters(parsed, found, parsed.shared_parameters if "*" in pattern.rpartition("/")[2] else None)
        elif option == "parameter":
            _set_parameter(parsed, value)
        elif option == "remap":
            _add_remap(parsed, value)
        elif option == "log-level":
            parsed.log_level = _log_level(value)
    parsed.logs_to_console = _last_of(_CONSOLE_SWITCHES, arguments) != "--disable-stdout-logs"
    parsed.logs_to_rosout = _last_of(_ROSOUT_SWITCHES, arguments) != "--disable-rosout-logs"
    return parsed


def _last_of(switches: tuple[str, ...], arguments: list[str]) -> str:
    """Return the last argument that is one of ``switches``; an empty text if there is none."""
    return next((argument for argument in reversed(arguments) if argument in switches), "")


_OPTIONS = {
    "-p": "parameter",
    "--param": "parameter",
    "--params-file": "params-file",
    "-r": "remap",
    "--remap": "remap",
    "--log-level": "log-level",
    "-e": "ignored",
    "--enclave": "ignored",
    "--log-config-file": "ignored",
}
_CONSOLE_SWITCHES = ("--enable-stdout-logs", "--disable-stdout-logs")
_ROSOUT_SWITCHES = ("--enable-rosout-logs", "--disable-rosout-logs")
# rcl accepts the last two for every node, and launch files pass them. They concern rcl's log files, which this node
# does not have.
_SWITCHES = (
    *_CONSOLE_SWITCHES,
    *_ROSOUT_SWITCHES,
    *("--enable-external-lib-logs", "--disable-external-lib-logs"),
)


def _options(arguments: list[str]) -> Iterator[tuple[str, str]]:
    remaining = iter(arguments)
    for argument in remaining:
        if argument in _SWITCHES:
            continue
        option = _OPTIONS.get(argument)
        if option is None:
            known = ", ".join((*_OPTIONS, *_SWITCHES))
            raise SetupError(f"unknown argument {argument!r} after --ros-args (known: {known})")
        value = next(remaining, None)
        if value is None:
            raise SetupError(f"{argument} needs a value after it")
        yield option, value


def _assignment(text: str, what: str) -> tuple[str, str, str]:
    """Split ``[node:]name:=value`` into node (or empty), name and value; ``what`` is ``the remap``, for errors."""
    left, separator, value = text.partition(":=")
    found = _LEFT_SIDE.fullmatch(left)
    if not separator or found is None:
        raise SetupError(f"{what} {text!r} is not of the form name:=value")
    return found["node"] or "", found["name"], value


def _identity(options: list[tuple[str, str]], default_name: str) -> NodeIdentity:
    given: dict[str, str] = {}
    for option, text in options:
        if option == "remap":
            node, source, target = _assignment(text, "the remap")
            if node in ("", default_name):
                # rcl's grammar accepts `__name` for `__node`.
                given.setdefault("__node" if source == "__name" else source, target)  # the first rule decides
    name, namespace = given.get("__node", default_name), given.get("__ns", "/")
    if not _NODE_NAME.fullmatch(name):
        raise SetupError(f"{name!r} is not a node name: letters, digits and underscores, not starting with a digit")
    if not _NAMESPACE.fullmatch(namespace):
        raise SetupError(f"{namespace!r} is not a namespace: a slash, then names that are separated by slashes")
    return NodeIdentity(name, namespace)


def _set_parameter(parsed: RosArguments, text: str) -> None:
    node, name, value = _assignment(text, "the parameter")
    if node not in ("", parsed.node.name):
        return
    try:
        _set_parameters(parsed, {name: strict_yaml.load(value)}, None if node else parsed.unaddressed_parameters)
    except strict_yaml.YamlTextError as error:
        raise SetupError(f"the value of the parameter {name}: {error}") from error


def _set_parameters(parsed: RosArguments, values: Mapping[str, Any], for_several: set[str] | None) -> None:
    """Set parameters, and add their names to ``for_several``, unless something that is for this node sets them, too."""
    for name, value in values.items():
        names = (parsed.shared_parameters, parsed.unaddressed_parameters)
        if for_several is None:
            for several in names:
                several.discard(name)
        elif name not in parsed.parameters or any(name in several for several in names):
            for_several.add(name)
        parsed.parameters[name] = value


def _add_remap(parsed: RosArguments, text: str) -> None:
    node, source, target = _assignment(text, "the remap")
    if node not in ("", parsed.node.name) or source.startswith("__"):
        return
    source, target = source.removeprefix("rostopic://"), target.removeprefix("rostopic://")
    for name in (source, target):
        if not is_topic(name):
            raise SetupError(f"{name!r} in the remap {text!r} is not a topic name")
    parsed.remaps.append((source, target))


def _log_level(text: str) -> str:
    """Return the level from ``level`` or ``logger:=level``. The name of the logger is ignored."""
    level = text.rpartition(":=")[2].lower()
    if level not in LOG_LEVELS:
        raise SetupError(f"unknown log level {level!r} (known: {', '.join(LOG_LEVELS)})")
    return level


def _read_params_file(path: Path, node: NodeIdentity) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the key and the parameters of each section of a parameter file that belongs to a node.

    A section of the file belongs to the node if its key is the node's name, its full name, or a wildcard that matches.
    """
    try:
        content = strict_yaml.load(read_text(path))
    except strict_yaml.YamlTextError as error:
        raise SetupError(error.in_file(path)) from error
    except OSError as error:
        raise SetupError(f"{path}: cannot read the file: {error.strerror}") from error
    if not isinstance(content, Mapping):
        raise SetupError(f"{path}: expected node names, each with `ros__parameters:` below it")
    for pattern, section in _sections(content):
        found = _section_parameters(path, pattern, section)
        if _matches(pattern, node):
            yield pattern, found


def _sections(content: Mapping[Any, Any], prefix: str = "") -> Iterator[tuple[str, Mapping[Any, Any]]]:
    """Yield key and content of each node's section in a parameter file, also of sections inside namespaces.

    The key is the node's name or a wildcard pattern, with the namespaces before it: ``/rover/udp_forwarder``.
    """
    for key, value in content.items():
        name = f"{prefix.rstrip('/')}/{str(key).strip('/')}" if prefix else str(key)
        if isinstance(value, Mapping) and "ros__parameters" not in value and value:
            yield from _sections(value, name if name.startswith("/") else f"/{name}")
        else:
            yield name, value


def _matches(pattern: str, node: NodeIdentity) -> bool:
    if not pattern.startswith("/"):
        pattern = f"/{pattern}"
    # rcl's wildcards: `/**` stands for any number of names, `*` for one.
    escaped = re.escape(pattern).replace(r"/\*\*", "(/[^/]+)*").replace(r"\*", "[^/]+")
    return re.fullmatch(escaped, node.full_name) is not None


def _section_parameters(path: Path, pattern: str, section: object) -> dict[str, Any]:
    parameters = section.get("ros__parameters") if isinstance(section, Mapping) else None
    if not isinstance(parameters, Mapping):
        raise SetupError(f"{path}: {pattern} has no `ros__parameters:` with names and values below it")
    return {str(name): value for name, value in parameters.items()}
