"""Actions of launch files, as the readers of YAML, XML and Python launch files create them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from roverlink.generator.diagnostics import Span

Text = Any
"""A text of a launch file: a text, a substitution, or a sequence of them (see `substitutions.text_of`)."""

_NOWHERE = Span("")

# Like those of `launch`, actions are equal to themselves only, and can be hashed.


@dataclass(slots=True, eq=False)
class Action:
    """Base class of all actions."""

    place: Span = _NOWHERE
    condition: tuple[bool, Text] | None = None
    """The condition's text, and the truth value that it must have."""
    unknown_options: dict[str, str] = field(default_factory=dict, kw_only=True)
    """Names of keyword arguments that the action does not have, each with the likely one (Python launch files only)."""


@dataclass(slots=True, eq=False)
class DeclareArgument(Action):
    """Declaration of an argument; it sets the default if nothing has set the argument."""

    name: Text = ""
    default: Text | None = None
    choices: tuple[str, ...] = ()
    description: str = ""


@dataclass(slots=True, eq=False)
class SetConfiguration(Action):
    """Set a variable of the launch file (`let`)."""

    name: Text = ""
    value: Text = ""


@dataclass(slots=True, eq=False)
class SetEnvironment(Action):
    """Set a variable of the environment."""

    name: Text = ""
    value: Text = ""


@dataclass(slots=True, eq=False)
class Group(Action):
    """Actions in a scope of their own."""

    actions: list[Action] = field(default_factory=list)
    scoped: bool = True
    configurations: Mapping[str, Text] = field(default_factory=dict)


@dataclass(slots=True, eq=False)
class PushNamespace(Action):
    """Put the following nodes into a namespace."""

    namespace: Text = ""


@dataclass(slots=True, eq=False)
class SetRemap(Action):
    """Remap a topic of the following nodes."""

    source: Text = ""
    target: Text = ""


@dataclass(slots=True, eq=False)
class SetParameter(Action):
    """Set a parameter of the following nodes."""

    name: Text = ""
    value: Any = None


@dataclass(slots=True, eq=False)
class SetParametersFromFile(Action):
    """Give a parameter file to the following nodes."""

    path: Text = ""


@dataclass(slots=True, eq=False)
class Include(Action):
    """Start what another launch file describes."""

    path: Text = ""
    arguments: list[tuple[Text, Text, Span]] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class GivenParameter:
    """A parameter that a launch file gives to a node; its value may be a mapping of more parameters."""

    name: Text
    value: Any
    place: Span
    is_text: bool = False
    """True if the value stays a text, even if it looks like a number."""


@dataclass(slots=True, eq=False)
class GivenFile:
    """A parameter file that a launch file gives to a node."""

    path: Text
    place: Span
    has_substitutions: bool = False
    root_key: Text = ""
    """Namespace that is put around the file's nodes (`RewrittenYaml` of nav2_common)."""
    rewrites: Mapping[str, Text] | None = None
    """Values that replace those of the file, by the name of the parameter; None if nothing rewrites the file."""


@dataclass(slots=True, eq=False)
class Remapping:
    """A name of a topic, service or action, and the name that replaces it."""

    source: Text
    target: Text
    place: Span
    target_place: Span


@dataclass(slots=True, eq=False)
class StartNode(Action):
    """Start a node, or load it into a container."""

    package: Text = ""
    executable: Text = ""
    plugin: Text = ""
    """C++ class of a node that is loaded into a container; then there is no executable."""
    name: Text | None = None
    namespace: Text | None = None
    parameters: list[GivenParameter | GivenFile] = field(default_factory=list)
    remappings: list[Remapping] = field(default_factory=list)
    arguments: list[Text] | str = field(default_factory=list)
    ros_arguments: list[Text] | str = field(default_factory=list)


@dataclass(slots=True, eq=False)
class LoadNodes(Action):
    """Start a container, or use one that is there, and load nodes into it."""

    container: StartNode | None = None
    nodes: list[StartNode] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class Execute(Action):
    """Run a program that is no node of a package."""

    command: list[Text] | str = field(default_factory=list)


@dataclass(slots=True, eq=False)
class Opaque(Action):
    """Actions that a function of a Python launch file returns when it is called with a context."""

    function: Callable[[Any], Any] = lambda _: None


@dataclass(slots=True, eq=False)
class Later(Action):
    """Actions that start when something has happened, such as the end of another program."""

    actions: list[Action] = field(default_factory=list)
