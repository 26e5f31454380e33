"""Parameter files of ROS 2 nodes: sections for nodes, each with parameters that know their places."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from pathlib import Path
from typing import Any

import yaml

from check_launch.expansion.entities import FAST_LOADER, UnreadableFileError, compose, place_of, plain, text_of_file
from check_launch.expansion.substitutions import RUN_TIME
from roverlink import bounded_files
from roverlink.generator.diagnostics import Span

KEY = "ros__parameters"
_ALIAS = re.compile(r"(?:^|[\s\[{,:-])\*[\w-]", re.MULTILINE)
"""Text that may be an alias of YAML, but not ``/**``."""
_FLOAT = re.compile(r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|(?i:inf|infinity|nan))")
"""Text that is a number for strtod."""


class Unknown:
    """A value that only the rover's computer knows."""

    def __repr__(self) -> str:
        return "a value that is known at run time only"

    def __reduce__(self) -> str:
        return "UNKNOWN"  # there is one, also for values from a child process


UNKNOWN = Unknown()


@dataclass(frozen=True, slots=True)
class GivenValue:
    """A parameter with the value that a file or a launch file gives to it."""

    name: str
    value: Any
    place: Span
    """Place of the last part of the name."""


@dataclass(frozen=True, slots=True)
class Section:
    """Parameters for the nodes whose full names match a pattern: ``/**``, ``/local_costmap/local_costmap``."""

    pattern: str
    place: Span
    values: tuple[GivenValue, ...]

    def matches(self, full_name: str) -> bool:
        """Return true if the section is for a node; ``full_name`` is its name with its namespace."""
        text = re.escape(self.pattern).replace(r"/\*\*", "(?:/[^/]+)*").replace(r"\*", "[^/]+")
        # "/**" stands for any nodes; before a name, for any namespaces
        return re.fullmatch(f"{text}/?", full_name) is not None or self.pattern in ("/**", "/**/")

    def at(self, place: Span) -> Section:
        """Return the section with another place for all of it."""
        values = tuple(GivenValue(given.name, given.value, place) for given in self.values)
        return Section(self.pattern, place, values)

    @property
    def node_name(self) -> str:
        """The last part of the pattern; ``**`` for all nodes."""
        return self.pattern.rpartition("/")[2]


class NoParametersError(UnreadableFileError):
    """Raised for a YAML file that ROS 2 does not take as a parameter file."""


class ParameterFile:
    """A parameter file. It keeps its sections, because a launch file is expanded with many values of its arguments."""

    def __init__(self, path: Path, shown: str) -> None:
        """Read the file; ``shown`` is its name in places. Raises `UnreadableFileError`."""
        text = text_of_file(path, shown)
        self._root, self._shown = compose(text, shown, of_parameters=True), shown
        refusals = chain(_without_node(self._root, shown), _refusals(self._root, shown, False), _aliases(text, shown))
        self.refused = next(refusals, None)
        """First message and place of what rcl_yaml_param_parser refuses; rewriting the file removes it."""
        self._has_sections = _has_sections(self._root)
        self._with_texts = list(dict.fromkeys(_with_texts(self._root)))
        self._sections: dict[tuple[str | None, ...], list[Section]] = {}

    def sections(self, text_of: Callable[[str], str | None] | None, of_component: bool = False) -> list[Section]:
        """Return the sections of the file. Raises `UnreadableFileError`.

        ``text_of`` replaces the substitutions in a text, and returns None if the text is not known; with None, the file
        has no substitutions. ``of_component`` says that a node in a container gets the file: launch_ros reads it then,
        and takes a file without sections as one for this node (launch_ros/utilities/to_parameters_list.py).
        """
        if self._root is None:
            return []
        if not isinstance(self._root, yaml.MappingNode):
            raise NoParametersError(place_of(self._root, self._shown), "a parameter file is a mapping of nodes")
        read = text_of or str
        texts = {text: None if RUN_TIME in text else read(text) for text in self._with_texts}
        is_one = of_component and not self._has_sections
        key = (str(is_one), *texts.values())
        if key not in self._sections:
            at = (self._shown, lambda text: texts.get(text, text))
            if is_one:
                values = tuple(_values(self._root, "", *at))
                self._sections[key] = [Section("/**", place_of(self._root, self._shown), values)]
            else:
                self._sections[key] = list(_sections(self._root, "", *at))
        return self._sections[key]


def _with_texts(node: yaml.Node | None) -> Iterator[str]:
    """Yield the texts in a file in which substitutions may stand, or what only the running system knows."""
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            yield from _with_texts(key)
            yield from _with_texts(value)
    elif isinstance(node, yaml.SequenceNode):
        for child in node.value:
            yield from _with_texts(child)
    elif isinstance(node, yaml.ScalarNode) and ("$(" in node.value or RUN_TIME in node.value):
        yield node.value


def _has_sections(node: yaml.Node | None) -> bool:
    pairs = node.value if isinstance(node, yaml.MappingNode) else ()
    return any(key.value == KEY or _has_sections(value) for key, value in pairs)


def _without_node(root: yaml.Node | None, shown: str) -> Iterator[tuple[str, Span]]:
    """Yield message and place of parameters above all names (``There are no node names before ros__parameters``)."""
    for key, _ in root.value if isinstance(root, yaml.MappingNode) else ():
        if key.value == KEY:
            yield f"'{KEY}' stands above the name of the node: put it below the name", place_of(key, shown)


def _refusals(node: yaml.Node | None, shown: str, in_parameters: bool) -> Iterator[tuple[str, Span]]:
    """Yield messages and places of parameters without a value, and of lists with mappings that ROS 2 refuses.

    rcl_yaml_param_parser says ``No value at line``. Of each mapping in a list, it takes only the first key for a key:
    ``Sequence should be of same type`` holds for the rest.
    """
    for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
        if in_parameters and isinstance(value, yaml.ScalarNode) and value.value == "" and not value.style:
            yield f"the parameter '{key.value}' has no value", place_of(key, shown)
        parts = value.value if in_parameters and isinstance(value, yaml.SequenceNode) else []
        pairs = [part.value for part in parts if isinstance(part, yaml.MappingNode)]
        words = [word for mapping in pairs for pair in mapping for word in pair if word is not mapping[0][0]]
        kinds = {type(value_of(word, str)) for word in words if isinstance(word, yaml.ScalarNode)}
        if len(kinds) > 1:
            yield f"'{key.value}' is a list of mappings, which ROS 2 does not read as a parameter", place_of(key, shown)
        yield from _refusals(value, shown, in_parameters or key.value == KEY)


def _aliases(text: str, shown: str) -> Iterator[tuple[str, Span]]:
    """Yield messages and places of aliases (``Will not support aliasing`` of rcl_yaml_param_parser)."""
    for event in yaml.parse(text, Loader=FAST_LOADER) if _ALIAS.search(text) else ():
        mark = event.start_mark
        if isinstance(event, yaml.AliasEvent) and mark is not None:
            message = f"ROS 2 reads no aliases in parameter files: write the values of '*{event.anchor}' here"
            yield message, Span(shown, mark.line + 1, mark.column + 1)


def is_parameter_file(path: Path) -> bool:
    """Return true if a YAML file has parameters of nodes; also if it is not UTF-8, which the check then reports."""
    try:
        text = bounded_files.read(path).decode("latin-1")  # each byte is a letter
    except OSError:
        return False
    return re.search(rf"^\s*['\"]?{KEY}['\"]?\s*:", text, re.MULTILINE) is not None


def _sections(
    node: yaml.MappingNode, pattern: str, shown: str, text_of: Callable[[str], str | None]
) -> Iterator[Section]:
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise UnreadableFileError(place_of(key, shown), "the name of a node must be a text")
        name = text_of(key.value) or ""
        if name == KEY:
            if not isinstance(value, yaml.MappingNode):
                raise NoParametersError(place_of(key, shown), f"'{KEY}' has no parameters; indent them below it")
            values = tuple(_values(value, "", shown, text_of))
            yield Section(pattern or "/", place_of(node, shown), values)
        elif isinstance(value, yaml.MappingNode):
            inner = f"{pattern}/{name.strip('/')}"
            for section in _sections(value, inner, shown, text_of):
                place = place_of(key, shown) if section.place == place_of(value, shown) else section.place
                yield Section(section.pattern, place, section.values)
        else:  # `Cannot have a value before ros__parameters` (rcl_yaml_param_parser)
            raise NoParametersError(place_of(key, shown), f"'{name}' stands outside of '{KEY}': put this key above it")


def _values(
    node: yaml.MappingNode, prefix: str, shown: str, text_of: Callable[[str], str | None]
) -> Iterator[GivenValue]:
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise UnreadableFileError(place_of(key, shown), "the name of a parameter must be a text")
        name = f"{prefix}{text_of(key.value) or key.value}"
        inner = value.value[-1] if isinstance(value, yaml.SequenceNode) and value.value else value
        if isinstance(inner, yaml.MappingNode):  # rcl_yaml_param_parser takes the mapping in a list for parameters, too
            yield from _values(inner, f"{name}.", shown, text_of)
        else:
            yield GivenValue(name, value_of(value, text_of), place_of(key, shown))


def value_of(node: yaml.Node, text_of: Callable[[str], str | None]) -> Any:
    """Return the value of a YAML node as ROS 2 types it; `UNKNOWN` if it is not known."""
    if isinstance(node, yaml.SequenceNode):
        values = [value_of(item, text_of) for item in node.value]
        lists = [value for value in values if isinstance(value, list)]
        if lists and values[-1] is lists[0]:
            return lists[0]  # rcl_yaml_param_parser forgets what stands before a list in a list
        return UNKNOWN if UNKNOWN in values else values
    if not isinstance(node, yaml.ScalarNode):
        return UNKNOWN
    text = text_of(node.value)
    if text is None:
        return UNKNOWN
    if node.style in ("'", '"', "|", ">"):
        return text
    return typed(text) if text != node.value else typed_node(node)


def typed_node(node: yaml.ScalarNode) -> Any:
    """Return the value of a scalar without quotation marks."""
    return typed(node.value) if _FLOAT.fullmatch(node.value) else plain(node)


@lru_cache(maxsize=1 << 14)  # launch files give the same values with each value of their arguments
def typed(text: str) -> Any:
    """Return the value of a text as ROS 2 types it without quotation marks."""
    if _FLOAT.fullmatch(text):
        return int(text) if text.lstrip("+-").isdigit() else float(text)
    try:
        return yaml.safe_load(text)
    except yaml.YAMLError:
        return text


def dumped(text: str) -> str | float:
    """Return what a node gets of a text in a Python launch file.

    launch_ros writes it with PyYAML, which leaves a number such as 1e6 without quotation marks, since it needs a dot
    and a sign to be one for YAML 1.1. rcl_yaml_param_parser reads it with strtod.
    """
    return float(text) if _FLOAT.fullmatch(text) and isinstance(yaml.safe_load(text), str) else text


def rewritten(sections: list[Section], root: str, rewrites: Mapping[str, Any]) -> list[Section]:
    """Return sections whose values and namespace nav2_common's RewrittenYaml has replaced."""
    if not rewrites and not root.strip("/"):
        return sections
    prefix = f"/{root.strip('/')}" if root.strip("/") else ""
    return [
        Section(
            f"{prefix}{section.pattern}",
            section.place,
            tuple(
                (
                    GivenValue(given.name, rewrites[given.name.rpartition(".")[2]], given.place)
                    if given.name.rpartition(".")[2] in rewrites
                    else given
                )
                for given in section.values
            ),
        )
        for section in sections
    ]
