"""Stand-ins for the Python packages launch, launch_ros, nav2_common and ament_index_python.

A Python launch file gets them where ROS 2 is not installed. Where it is, subclasses of the real classes create them
(see `real_launch`): the real objects keep no places, and give no values for arguments that only the user knows. The
stand-ins have the constructors that launch files use. An object that they do not know is replaced by `Ignored`, which
accepts everything and starts nothing.
"""

from __future__ import annotations

import ast
import itertools
import os
import sys
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from types import FunctionType, MethodType, ModuleType
from typing import Any, TypeVar

import yaml

from check_launch.expansion import real_launch, substitutions
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
    Opaque,
    PushNamespace,
    Remapping,
    SetConfiguration,
    SetEnvironment,
    SetParameter,
    SetParametersFromFile,
    SetRemap,
    StartNode,
)
from check_launch.expansion.entities import UnreadableFileError, compose
from check_launch.expansion.launch_context import UNKNOWN_SHARE, Context, Packages, package_of_share
from check_launch.expansion.launch_imports import Ignored
from check_launch.expansion.substitutions import Substitution, UnknownTextError, is_true, text_of
from check_launch.misspellings import nearest
from check_launch.rules.stated_facts import stated_facts
from roverlink import bounded_files
from roverlink.generator.diagnostics import Span

_OF_PROCESS = (
    *("prefix", "cwd", "env", "additional_env", "shell", "sigterm_timeout", "sigkill_timeout", "emulate_tty", "output"),
    *("output_format", "cached_output", "log_cmd", "on_exit", "respawn", "respawn_delay", "respawn_max_retries"),
)
_OF_COMPONENT = ("package", "plugin", "name", "namespace", "parameters", "remappings", "extra_arguments")
_OF_NODE = ("package", "executable", "name", "namespace", "parameters", "remappings", "arguments", "ros_arguments")
_OF_PROGRAM = (*_OF_NODE, "exec_name", *_OF_PROCESS)
"""Keyword arguments of ComposableNode, of Node, and of the actions below Node (launch, launch_ros)."""


_OF_MOVEIT = (
    *("demo", "move_group", "moveit_rviz", "rsp", "setup_assistant", "spawn_controllers", "static_virtual_joint_tfs"),
    "warehouse_db",
)
"""Launch files that moveit_configs_utils generates (moveit_configs_utils/launches.py)."""


class LaunchDescription:
    """Result of a launch file: a list of actions."""

    def __init__(self, initial_entities: Iterable[Any] | None = None, **_: Any) -> None:
        if isinstance(initial_entities, Action):
            raise TypeError("LaunchDescription takes a list: write LaunchDescription([...]) around the actions")
        self.entities = list(initial_entities or ())

    def add_action(self, action: Any) -> None:
        """Add an action at the end."""
        self.entities.append(action)

    add_entity = add_action

    def get_launch_arguments(self, conditional_inclusion: bool = False) -> list[Any]:
        """Return the declarations of arguments."""
        del conditional_inclusion
        return [entity for entity in self.entities if isinstance(entity, DeclareArgument)]


class IfCondition:
    """A condition that holds if a text is true."""

    wanted = True

    def __init__(self, predicate_expression: Any) -> None:
        self.expression = _text("the condition", predicate_expression)

    def evaluate(self, context: Context) -> bool:
        """Return true if the condition holds."""
        return is_true(text_of(self.expression, context)) == self.wanted

    _predicate_func = evaluate


class UnlessCondition(IfCondition):
    """A condition that holds if a text is false."""

    wanted = False


class LaunchConfigurationEquals(IfCondition):
    """A condition that holds if an argument has a value."""

    def __init__(self, launch_configuration_name: str, expected_value: Any) -> None:
        name = substitutions.LaunchConfiguration(launch_configuration_name, default="")
        super().__init__(substitutions.EqualsSubstitution(name, "" if expected_value is None else expected_value))


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """A condition that holds if an argument has another value."""

    wanted = False


@dataclass(slots=True)
class ParameterValue:
    """A parameter's value with a type that YAML does not decide."""

    value: Any
    value_type: Any = None


@dataclass(slots=True)
class ParameterFile:
    """A parameter file in which substitutions may stand."""

    param_file: Any
    allow_substs: Any = False


@dataclass(slots=True)
class ComposableNode:
    """A node that is loaded into a container."""

    node: StartNode


class RewrittenYaml(Substitution):
    """A parameter file of which nav2_common replaces values."""

    def __init__(
        self,
        source_file: Any,
        param_rewrites: Mapping[Any, Any] | None = None,
        root_key: Any = "",
        key_rewrites: Any = None,
        convert_types: bool = False,
        **_: Any,
    ) -> None:
        self.source_file, self.root_key, self.param_rewrites = source_file, root_key, param_rewrites or {}

    def perform(self, context: substitutions.Surroundings) -> str:
        return text_of(self.source_file, context)


class ReplaceString(Substitution):
    """A file in which nav2_common replaces texts."""

    def __init__(self, source_file: Any, replacements: Mapping[str, Any] | None = None, condition: Any = None) -> None:
        self.source_file, self.replacements, self.condition = source_file, replacements or {}, condition

    def perform(self, context: Any) -> str:
        source: str = context.packages.existing(text_of(self.source_file, context), os.path.dirname(context.file))
        if self.condition is not None and not self.condition.evaluate(context):
            return source
        try:
            text = bounded_files.read_text(source)
        except OSError:
            return source  # whoever reads it says why
        for old, new in self.replacements.items():
            text = text.replace(old, text_of(new, context))
        path = Path(tempfile.gettempdir(), f"{sha256(os.fsencode(source) + text.encode()).hexdigest()}.yaml")
        path.write_text(text, encoding="utf-8")
        context.sources[str(path)] = source
        return str(path)

    def stored(self) -> Any:
        return substitutions.stored_text(self.source_file)


class HasNodeParams(Substitution):
    """``True`` if a parameter file has a section for a node (nav2_common)."""

    def __init__(self, source_file: Any, node_name: str) -> None:
        self.source_file, self.node_name = source_file, node_name

    def perform(self, context: substitutions.Surroundings) -> str:
        path = text_of(self.source_file, context)
        try:
            root = compose(bounded_files.read_text(path), path)
        except (OSError, UnreadableFileError) as error:
            raise UnknownTextError(path) from error
        return str(isinstance(root, yaml.MappingNode) and self.node_name in {key.value for key, _ in root.value})

    def stored(self) -> Any:
        return {"unknown": ""}


class ParseMultiRobotPose:
    """Robots on the command line of `ros2 launch` (nav2_common); a check has none."""

    def __init__(self, target_argument: str) -> None:
        del target_argument

    def value(self) -> dict[str, Any]:
        """Return the robots by their names."""
        return {}


@dataclass(slots=True)
class _File:
    """The source of a Python launch file, to find the places of literals in it."""

    path: str
    shown: str
    literals: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    spans: dict[int, int] = field(default_factory=dict)
    columns: dict[int, int] = field(default_factory=dict)
    """Column of the first call in each line."""

    def read(self, tree: ast.AST) -> None:
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                self.literals.setdefault(node.value, []).append((node.lineno, node.col_offset + 1))
            elif isinstance(node, ast.Call):
                end = node.end_lineno or node.lineno
                self.spans[node.lineno] = max(end, self.spans.get(node.lineno, 0))
                column = node.col_offset + 1
                self.columns[node.lineno] = min(column, self.columns.get(node.lineno, column))

    def place_of(self, text: Any, near: Span) -> Span:
        """Return the place of a literal text: in the call at a place, or else the first one in the file."""
        if isinstance(text, list | tuple) and text:
            text = text[0]
        found = self.literals.get(text, ()) if isinstance(text, str) else ()
        inside = [literal for literal in found if near.line <= literal[0] <= self.spans.get(near.line, near.line)]
        line, column = next(iter(sorted(inside) or sorted(found)), (near.line, near.column))
        return Span(self.shown, line, column)


class StandIns:
    """The stand-in modules for one launch file."""

    def __init__(self, path: Path, shown: str, packages: Packages) -> None:
        self._file = _File(str(path), shown)
        self._packages = packages
        self.absent: dict[str, Span] = {}
        """Packages whose share folders the file has asked for, and that are not there, with the places."""

    def read(self, tree: ast.AST) -> None:
        """Remember the literals of the file, which are found again when an object with one of them is created."""
        self._file.read(tree)

    def place(self) -> Span:
        """Return the place in the launch file that is being executed."""
        frame = sys._getframe(1)
        while frame is not None and frame.f_code.co_filename != self._file.path:
            frame = frame.f_back  # type: ignore[assignment]
        if frame is None:
            return Span(self._file.shown)
        if hasattr(frame.f_code, "co_positions"):  # since Python 3.11; before, only the line is known
            line, _, start, _ = next(itertools.islice(frame.f_code.co_positions(), frame.f_lasti // 2, None))
            if line is not None and start is not None:
                return Span(self._file.shown, line, start + 1)
        return Span(self._file.shown, frame.f_lineno, self._file.columns.get(frame.f_lineno, 0))

    def modules(self) -> dict[str, ModuleType]:
        """Return the modules by their names, for `sys.modules`."""
        of_sources = dict.fromkeys(
            (
                *("PythonLaunchDescriptionSource", "AnyLaunchDescriptionSource", "FrontendLaunchDescriptionSource"),
                *("XMLLaunchDescriptionSource", "YAMLLaunchDescriptionSource", "LaunchDescriptionSource"),
            ),
            _source,
        )
        of_substitutions = {
            name: member
            for name, member in vars(substitutions).items()
            if isinstance(member, type) and issubclass(member, Substitution)
        }
        share, packages = self._share, self._packages

        class FindPackageShare(substitutions.FindPackageShare):
            def find(self, package: str) -> str:
                return share(package)

        of_substitutions["FindPackageShare"] = FindPackageShare

        class LaunchContext(Context):
            def __init__(self, **_: Any) -> None:
                Context.__init__(self, packages, environment=dict(os.environ))

        own = (
            {}  # what a launch file derives its own classes from
            if real_launch.is_installed()
            else {
                "LaunchDescription": LaunchDescription,
                "Substitution": Substitution,
                "LaunchContext": LaunchContext,
                "Action": Action,
            }
        )
        actions = {
            "DeclareLaunchArgument": self._declare,
            "SetLaunchConfiguration": self._set_configuration,
            "SetEnvironmentVariable": self._set_environment,
            "AppendEnvironmentVariable": Ignored,
            "GroupAction": self._group,
            "IncludeLaunchDescription": self._include,
            "ExecuteProcess": self._execute,
            "ExecuteLocal": self._execute,
            "OpaqueFunction": self._opaque,
            "RegisterEventHandler": self._later,
            "TimerAction": self._timer,
        }
        handlers = dict.fromkeys(("OnProcessExit", "OnProcessStart", "OnProcessIO", "OnExecutionComplete"), _handler)
        of_ros = {
            "Node": self._node,
            "LifecycleNode": self._node,
            "ComposableNodeContainer": self._container,
            "LoadComposableNodes": self._load,
            "PushRosNamespace": self._push,
            "PushROSNamespace": self._push,
            "SetRemap": self._remap,
            "SetParameter": self._parameter,
            "SetParametersFromFile": self._parameters_from_file,
            "SetUseSimTime": lambda value, **options: self._parameter("use_sim_time", value, **options),
            "RosTimer": self._timer,
        }
        descriptions = {
            "ComposableNode": self._component,
            "ParameterValue": ParameterValue,
            "ParameterFile": ParameterFile,
            "Parameter": lambda name, value, value_type=None: {name: ParameterValue(value, value_type)},
        }
        conditions = {
            condition.__name__: condition
            for condition in (IfCondition, UnlessCondition, LaunchConfigurationEquals, LaunchConfigurationNotEquals)
        }
        found = {
            "get_package_share_directory": self._share,
            "get_package_share_path": lambda name: Path(self._share(name)),
            "get_package_prefix": self._share,
            "get_search_paths": self._packages.prefixes,
            "PackageNotFoundError": KeyError,
        }
        contents: dict[str, Mapping[str, Any]] = {
            "launch": own,
            "launch.actions": actions,
            "launch.substitutions": of_substitutions,
            "launch.conditions": conditions,
            "launch.launch_description": own,
            "launch.launch_context": own,
            "launch.substitution": own,
            "launch.launch_description_sources": of_sources,
            "launch.event_handlers": handlers,
            "launch.events": {},
            "launch.events.process": {},
            "launch.utilities": {},
            "launch.some_substitutions_type": {},
            "launch_xml": {},
            "launch_xml.launch_description_sources": of_sources,
            "launch_yaml": {},
            "launch_yaml.launch_description_sources": of_sources,
            "launch_ros": {},
            "launch_ros.actions": of_ros,
            "launch_ros.descriptions": descriptions,
            "launch_ros.parameter_descriptions": descriptions,
            "launch_ros.substitutions": of_substitutions,
            "launch_ros.events": {},
            "launch_ros.events.lifecycle": {},
            "launch_ros.event_handlers": {},
            "nav2_common": {},
            "nav2_common.launch": {
                stand_in.__name__: stand_in
                for stand_in in (RewrittenYaml, ReplaceString, HasNodeParams, ParseMultiRobotPose)
            },
            "launch_param_builder": {},
            "moveit_configs_utils": {},
            "moveit_configs_utils.launches": {f"generate_{name}_launch": self._of_moveit for name in _OF_MOVEIT},
            "ament_index_python": found,
            "ament_index_python.packages": found,
        }
        modules = {name: _module(name, names) for name, names in contents.items()}
        if real_launch.is_installed():
            inner = (name for name in sys.modules if name.rpartition(".")[0] in contents and name not in contents)
            contents |= {name: contents[name.rpartition(".")[0]] for name in list(inner)}
            modules = {
                name: real_launch.recording(name, names) or modules.get(name) or _module(name, names)
                for name, names in contents.items()
            }
        for name, module in modules.items():
            if "." in name:
                setattr(modules[name.rpartition(".")[0]], name.rpartition(".")[2], module)
        return modules

    def _share(self, package: str) -> str:
        found = self._packages.share(package)
        if package_of_share(found) and isinstance(package, str):  # not `Ignored`
            self.absent.setdefault(package, self._file.place_of(package, self.place()))
        return found

    def _declare(
        self, name: str, *, default_value: Any = None, description: Any = None, choices: Any = None, **options: Any
    ) -> Action:
        place = self._file.place_of(name, self.place())
        _text("'default_value'", default_value)
        action = DeclareArgument(place, None, name, default_value, tuple(choices or ()), str(description or ""))
        return _with(action, options, "default_value", "description", "choices")

    def _set_configuration(self, name: Any, value: Any, **options: Any) -> Action:
        return _with(SetConfiguration(self.place(), None, name, _text("'value'", value)), options)

    def _set_environment(self, name: Any, value: Any, **options: Any) -> Action:
        return _with(SetEnvironment(self.place(), None, name, _text("'value'", value)), options)

    def _group(
        self, actions: Iterable[Any], *, scoped: bool = True, launch_configurations: Any = None, **options: Any
    ) -> Action:
        action = Group(self.place(), None, _actions(actions), scoped, launch_configurations or {})
        return _with(action, options, "scoped", "forwarding", "launch_configurations")

    def _include(self, launch_description_source: Any, *, launch_arguments: Any = (), **options: Any) -> Action:
        place = self.place()
        if isinstance(launch_arguments, Mapping):
            raise TypeError("'launch_arguments' must be pairs: write '.items()' behind the dictionary")
        arguments = [(name, value, self._file.place_of(name, place)) for name, value in launch_arguments or ()]
        return _with(Include(place, None, launch_description_source, arguments), options, "launch_arguments")

    def _of_moveit(self, *_: Any, **__: Any) -> LaunchDescription:
        """Return what a function of moveit_configs_utils starts: an unknown launch file, also beside its sources."""
        return LaunchDescription([Include(self.place(), None, f"{UNKNOWN_SHARE}moveit_configs_utils.launches/launch")])

    def _execute(self, *, cmd: Any = (), **options: Any) -> Action:
        return _with(Execute(self.place(), None, _words("cmd", cmd)), options, "cmd", "name", *_OF_PROCESS)

    def _opaque(self, *, function: Any, args: Any = None, kwargs: Any = None, **options: Any) -> Action:
        action = Opaque(self.place(), None, lambda context: function(context, *(args or ()), **(kwargs or {})))
        return _with(action, options, "function", "args", "kwargs")

    def _later(self, event_handler: Any, **options: Any) -> Action:
        actions = event_handler if isinstance(event_handler, list) else []
        return _with(Later(self.place(), None, _actions(actions)), options)

    def _timer(self, *, actions: Iterable[Any] = (), **options: Any) -> Action:
        return _with(Later(self.place(), None, _actions(actions)), options, "period", "actions", "cancel_on_shutdown")

    def _node(
        self,
        *,
        executable: Any = "",
        package: Any = "",
        plugin: Any = "",
        name: Any = None,
        namespace: Any = None,
        parameters: Any = None,
        remappings: Any = None,
        arguments: Any = None,
        ros_arguments: Any = None,
        **options: Any,
    ) -> StartNode:
        place = self.place()
        if not isinstance(parameters, list | Ignored | None):
            raise TypeError("'parameters' must be a list, such as [{'rate': 5.0}, 'file.yaml']")
        if not isinstance(remappings, Ignored) and not all(_is_pair(pair) for pair in remappings or ()):
            raise TypeError("'remappings' must be a list of pairs, such as [('scan', '/lidar/scan')]")
        for option, value in {"package": package, "executable": executable, "name": name}.items():
            _text(f"'{option}'", value)
        action = StartNode(
            place,
            None,
            package or "",
            executable or "",
            plugin or "",
            name,
            namespace,
            [parameter for given in parameters or () for parameter in self._given(given, place)],
            [
                Remapping(source, target, self._file.place_of(source, place), self._file.place_of(target, place))
                for source, target in remappings or ()
            ],
            _words("arguments", arguments),
            _words("ros_arguments", ros_arguments),
        )
        return _with(action, options, *_OF_PROGRAM)

    def _component(self, **options: Any) -> ComposableNode:
        node = self._node(**{name: option for name, option in options.items() if name in _OF_NODE or name == "plugin"})
        return ComposableNode(_with(node, options, *_OF_COMPONENT))

    def _given(self, given: Any, place: Span) -> Iterable[GivenParameter | GivenFile]:
        if isinstance(given, Mapping):
            for name, value in given.items():
                read, is_text = _value(value)
                yield GivenParameter(name, read, self._file.place_of(name, place), is_text)
            return
        has_substitutions = False
        if isinstance(given, ParameterFile):
            has_substitutions = given.allow_substs is True or str(given.allow_substs).lower() == "true"
            given = given.param_file
        if isinstance(given, set | frozenset):  # {'name', value}: `launch` reads a path in several parts
            given = sorted(given, key=str)
        if isinstance(given, RewrittenYaml):
            yield GivenFile(given.source_file, place, has_substitutions, given.root_key, given.param_rewrites)
        elif not isinstance(given, Ignored):
            yield GivenFile(given, self._file.place_of(given, place), has_substitutions)

    def _container(self, *, composable_node_descriptions: Any = None, **options: Any) -> Action:
        own = self._node(**options)
        condition, own.condition = own.condition, None
        unknown, own.unknown_options = own.unknown_options, {}
        nodes = _components(composable_node_descriptions)
        return LoadNodes(own.place, condition, own, nodes, unknown_options=unknown)

    def _load(
        self, *, composable_node_descriptions: Any = None, target_container: Any = None, **options: Any
    ) -> Action:
        action = LoadNodes(self.place(), None, None, _components(composable_node_descriptions))
        return _with(action, options, "composable_node_descriptions", "target_container")

    def _push(self, namespace: Any, **options: Any) -> Action:
        return _with(PushNamespace(self.place(), None, namespace), options)

    def _remap(self, src: Any, dst: Any, **options: Any) -> Action:
        return _with(SetRemap(self._file.place_of(src, self.place()), None, src, dst), options)

    def _parameter(self, name: Any, value: Any, **options: Any) -> Action:
        return _with(SetParameter(self._file.place_of(name, self.place()), None, name, _value(value)[0]), options)

    def _parameters_from_file(self, filename: Any, **options: Any) -> Action:
        return _with(SetParametersFromFile(self.place(), None, filename), options, "node_name")


def _components(descriptions: Any) -> list[StartNode]:
    return [part.node for part in descriptions or () if isinstance(part, ComposableNode)]


def _value(value: Any) -> tuple[Any, bool]:
    """Return a parameter's value, and true if it stays a text. Texts do; those of substitutions are read as YAML."""
    if isinstance(value, ParameterValue):
        return value.value, value.value_type is str
    if isinstance(value, str):
        return value, True
    if isinstance(value, Mapping):
        return {name: _value(inner)[0] for name, inner in value.items()}, False
    return value, False


Made = TypeVar("Made", bound=Action)


def _with(action: Made, options: Mapping[str, Any], *known: str) -> Made:
    """Return an action with its condition, and with its unknown options; ``known`` are the names of the others."""
    condition = options.get("condition")
    if isinstance(condition, IfCondition):
        action.condition = condition.wanted, condition.expression
    elif not isinstance(condition, Ignored | None):
        raise TypeError(f"'condition' is a {type(condition).__name__}: write IfCondition(...)")
    names = ("condition", *known)
    renamed = stated_facts().renamed_options
    action.unknown_options = {name: renamed.get(name) or nearest(name, names) for name in options if name not in names}
    return action


def _is_pair(pair: Any) -> bool:
    return isinstance(pair, Ignored) or (isinstance(pair, tuple) and len(pair) == 2)  # source and target


def _text(what: str, text: Any) -> Any:
    """Return a text, or texts in a row. Raises `TypeError`, as `launch` does, if it is or contains a number."""
    wrong = [part for part in (text if isinstance(text, list | tuple) else [text]) if isinstance(part, int | float)]
    if wrong:
        raise TypeError(f"{what} contains {wrong[0]!r}, which is no text: write '{wrong[0]}' with quotation marks")
    return text


def _words(option: str, words: Any) -> list[Any] | str:
    """Return the words of a command line; each letter of one text is a word. Raises `TypeError` for other words."""
    if isinstance(words, str):
        return words
    found: list[Any] = _text(f"'{option}'", list(words or ()))
    return found


def _actions(values: Iterable[Any]) -> list[Action]:
    found: list[Action] = []
    for value in map(real_launch.stand_in_of, values or ()):
        if isinstance(value, Action):
            found.append(value)
        elif isinstance(value, LaunchDescription):
            found += _actions(value.entities)
        elif isinstance(value, str | list | tuple | None) and not real_launch.is_installed():
            raise TypeError(f"{'None' if value is None else f'a {type(value).__name__}'} stands in place of an action")
    return found


def actions_of(value: Any) -> list[Action]:
    """Return the actions in what a launch file, or a function of it, has returned."""
    value = real_launch.stand_in_of(value)
    if isinstance(value, LaunchDescription):
        return _actions(value.entities)
    if isinstance(value, Action):
        return [value]
    return _actions(value) if isinstance(value, list | tuple) else []


def _source(launch_file_path: Any = "", **options: Any) -> Any:
    return launch_file_path if launch_file_path else options.get("location", "")


def _handler(
    target_action: Any = None, on_exit: Any = None, on_start: Any = None, on_completion: Any = None, **_: Any
) -> list[Any]:
    actions = on_exit or on_start or on_completion
    return list(actions) if isinstance(actions, list | tuple) else [actions] if isinstance(actions, Action) else []


def _module(name: str, contents: Mapping[str, Any]) -> ModuleType:
    module = ModuleType(name)
    for attribute, content in contents.items():
        is_class = name.startswith("launch") and isinstance(content, FunctionType | MethodType)
        made = real_launch.derivable(attribute, content) if is_class else real_launch.derived(content)
        vars(module)[attribute] = made
    vars(module)["__getattr__"] = _unknown
    vars(module)["__path__"] = []
    return module


def _unknown(name: str) -> Any:
    if name.startswith("__"):
        raise AttributeError(name)
    return (
        substitutions.UnknownSubstitution
        if name.endswith("Substitution") or name in ("Command", "FindExecutable")
        else Ignored
    )
