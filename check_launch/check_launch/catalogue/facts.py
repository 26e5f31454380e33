"""Facts about ROS 2 packages: their executables, and what each node has: parameters, topics, plugins and frames.

Names of parameters are patterns: ``{#}`` stands for a number, ``{*}`` for any name, and ``{x}`` for each name in the
value of the parameter x of the same node or plugin. Other texts may contain ``$(x)``, the value of the parameter x. In
the name of a topic, ``{node}`` is the name of the node, and ``../`` the namespace around the node's own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

OWN_SOURCE = "roverlink"
"""Source of the packages of this project, in `Package.source`."""
WORKSPACE_SOURCE = "workspace"
"""Source of the packages of a workspace."""
Scalar = str | int | float | bool
Value = Scalar | list[Any] | None


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a node or plugin."""

    type: str = ""
    """Such as ``double`` or ``string_array``; empty if it is not known."""
    default: Value = None
    """None if there is no default, or if it is not known."""
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[Scalar, ...] = ()


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A topic, service or action of a node."""

    kind: str
    """publisher, subscription, service, client, action or action_client."""
    name: str
    type: str = ""
    """Such as ``nav_msgs/msg/Odometry``; empty if it is not known."""
    reliability: str = ""
    """``reliable``, ``best_effort``, ``$(x)`` for a parameter; empty if it is not known."""
    durability: str = ""
    """``volatile`` or ``transient_local``; empty if it is not known."""
    when: str = ""
    """Condition on parameters under which the node has it, such as ``$(subscribe_scan)``; empty for always."""
    needed: str = ""
    """Condition under which the node does not work without another end; ``true`` for always, empty for never."""


@dataclass(frozen=True, slots=True)
class Transform:
    """A transform that a node publishes on /tf or /tf_static."""

    parent: str
    child: str
    when: str = ""


@dataclass(frozen=True, slots=True)
class PluginSlot:
    """A parameter that names plugins of a node or of another plugin. Parameters of a plugin begin with its name."""

    parameter: str
    base: str
    """C++ base class of the plugins that can be loaded."""
    type_key: str = ""
    """Last part of the parameter with the type of a plugin, ``plugin`` for ``NAME.plugin``.

    If it is empty, the names in `parameter` are types themselves, perhaps shortened (see `spellings`)."""
    spellings: tuple[str, ...] = ()
    """Types that a shortened name ``{}`` may stand for, such as ``dwb_critics::{}Critic``."""
    is_type: bool = False
    """True if the value of `parameter` is a type, and the plugin's parameters have no prefix of their own."""


@dataclass(frozen=True, slots=True)
class SubNode:
    """A node that a node creates in its own process, such as the costmap of a controller."""

    name: str
    namespace: str
    class_name: str
    """Name of the class; empty if a parameter of the node names the plugin."""
    type_parameter: str = ""
    """Pattern of the parameters that name plugins, ``{*}.type`` for a node x with the type in ``x.type``."""


@dataclass(frozen=True, slots=True)
class SharedParameters:
    """Parameters that a node shares with others: those of a set whose names begin with one of the groups."""

    set: str
    groups: tuple[str, ...] = ()
    """Groups (the text before ``/``) that the node has; all if empty. A ``*`` at the end stands for any rest."""
    without: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class NodeClass:
    """A class of nodes, or of plugins."""

    name: str
    default_name: str = ""
    """Name of the node if a launch file gives none; empty for plugins."""
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    """Parameters by the patterns of their names; those of a plugin without the plugin's name."""
    of_node: Mapping[str, Parameter] = field(default_factory=dict)
    """Parameters of the node that a plugin declares, by the patterns of their names."""
    of_parent: Mapping[str, Parameter] = field(default_factory=dict)
    """Parameters of the plugin around a plugin that this one declares."""
    endpoints: tuple[Endpoint, ...] = ()
    slots: tuple[PluginSlot, ...] = ()
    nodes: tuple[SubNode, ...] = ()
    transforms: tuple[Transform, ...] = ()
    frames: tuple[str, ...] = ()
    """Frames that the node looks up, such as ``$(robot_base_frame)``."""
    shared: tuple[SharedParameters, ...] = ()
    has_open_topics: bool = False
    """True if a file decides which topics the node has, as for RViz."""
    arguments: Mapping[str, str] = field(default_factory=dict)
    """Parameters that are set by arguments of the command line, such as ``frame_id`` by ``--frame-id``.

    An option that ends with a colon stands before its value in one word: ``topic:NAME``. With an option that sets no
    parameter, the program is another node, of which nothing is known."""
    topic_patterns: tuple[str, ...] = ()
    """Names of topics that the node may have, too, with ``{*}`` for any text."""
    is_partial: bool = False
    """True if the sources may have more parameters and topics than these."""
    other_texts: frozenset[str] = frozenset()
    """Texts in the sources of a workspace that were not understood: each may name one more parameter or topic."""


@dataclass(frozen=True, slots=True)
class Plugin:
    """A class that pluginlib can load."""

    class_name: str
    base: str
    package: str
    message_types: tuple[str, ...] = ()
    """Types of the messages that a display of RViz shows; empty for other plugins."""


@dataclass(frozen=True, slots=True)
class ParameterSet:
    """Parameters that several nodes share, with those that had another name in earlier versions."""

    parameters: Mapping[str, Parameter]
    renamed: Mapping[str, str]
    """New name by the old name; the new name is empty if the parameter is gone."""


@dataclass(frozen=True, slots=True)
class Package:
    """A ROS 2 package."""

    name: str
    version: str
    source: str
    """Name of the source in `Catalogue.sources`."""
    executables: Mapping[str, str]
    """Name of the class of the node by the name of the executable; empty if the class is not known."""
    components: Mapping[str, str]
    """Name of the class of a node by the name that a container loads, as the build registers it."""
    launch_files: Mapping[str, Any]
    """Descriptions of the package's launch files by their paths in its share folder (see `expansion.stored`)."""
    is_partial: bool = False
    """True if the package may have more executables and components than these."""
    build_words: frozenset[str] = frozenset()
    """Words in the build files of a package of the workspace: each may be the name of one more executable."""


@dataclass(frozen=True, slots=True)
class Source:
    """The checkout from which facts were extracted."""

    repository: str
    commit: str
    date: str
    """Date of the commit."""


@dataclass(frozen=True, slots=True)
class Catalogue:
    """All facts for one ROS 2 distribution."""

    distribution: str
    sources: Mapping[str, Source]
    packages: Mapping[str, Package]
    classes: Mapping[str, NodeClass]
    plugins: Mapping[str, Plugin]
    sets: Mapping[str, ParameterSet]
