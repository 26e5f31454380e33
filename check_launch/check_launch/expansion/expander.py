"""Expansion of a launch file with given values of its arguments: the nodes that it starts."""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import MappingProxyType
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
    Opaque,
    PushNamespace,
    SetConfiguration,
    SetEnvironment,
    SetParameter,
    SetParametersFromFile,
    SetRemap,
    StartNode,
)
from check_launch.expansion.child_process import (
    AT_ONCE,
    DEFAULT_LIMITS,
    ChildEndedError,
    ChildWaitsError,
    Limits,
    started,
)
from check_launch.expansion.declarative_files import OfRos1Error, read_declarative
from check_launch.expansion.entities import UnreadableFileError
from check_launch.expansion.launch_context import Context, Packages, package_of_share
from check_launch.expansion.launch_imports import Ignored
from check_launch.expansion.parameter_files import (
    UNKNOWN,
    GivenValue,
    ParameterFile,
    Section,
    dumped,
    rewritten,
    typed,
)
from check_launch.expansion.python_files import NeedsMoreError, PythonFile, is_python
from check_launch.expansion.stored_files import actions_of_stored
from check_launch.expansion.substitutions import (
    RUN_TIME,
    EqualsSubstitution,
    LaunchConfiguration,
    PythonExpression,
    TooLongTextError,
    UnknownTextError,
    is_boolean,
    is_true,
    text_of,
)
from check_launch.expansion.written_text import WrongTextError, parse_text
from check_launch.misspellings import all_nearest, did_you_mean, misspelt
from check_launch.rules.launch_rules import (
    InvalidName,
    MissingFile,
    NotExpanded,
    OldName,
    UndeclaredArgument,
    UnknownAction,
    UnreadableLaunchFile,
    WrongArgumentValue,
    as_hint,
    as_warning,
)
from check_launch.rules.stated_facts import stated_facts
from roverlink import bounded_files
from roverlink.generator.diagnostics import Diagnostic, Rule, Severity, Span

_DEEPEST = 30  # includes within includes
_MOST_INCLUDES = 1000
_MOST_NODES = 5000
_MOST_MEANT = 3  # names in advice
_MOST_VARIATIONS = 200
_FROM_ROS1 = "in ROS 2 it is <node exec=...>, <param from=...>, $(var x) and $(find-pkg-share x)"
_WRONG_NODE = re.compile(r"[^A-Za-z0-9_]|^\d")
_WRONG_TOPIC = re.compile(r"[^A-Za-z0-9_/~{}:*\\]|(?:^|/)\d")


@dataclass(frozen=True, slots=True)
class FileUse:
    """A parameter file that a node gets."""

    place: Span
    """Place of the path in the launch file."""
    shown: str
    sections: tuple[Section, ...]


@dataclass(frozen=True, slots=True)
class StartedRemapping:
    """A remapping that a node gets; ``is_general`` if it is for all nodes of a group."""

    source: str | None
    target: str | None
    place: Span
    target_place: Span
    is_general: bool = False


@dataclass(frozen=True, slots=True)
class StartedNode:
    """A node that a launch file starts. A text is None if it is known at run time only."""

    place: Span
    package: str | None
    executable: str | None
    plugin: str | None
    """C++ class of a node in a container; empty for a program."""
    name: str | None
    """Empty if the launch file gives no name."""
    namespace: str | None
    values: tuple[GivenValue, ...] = ()
    general_values: tuple[GivenValue, ...] = ()
    """Parameters that the launch file sets for all nodes of a group."""
    files: tuple[FileUse, ...] = ()
    remappings: tuple[StartedRemapping, ...] = ()
    arguments: tuple[str | None, ...] = ()
    has_unknown_files: bool = False
    """True if the node gets a parameter file that is not here."""
    shown: Callable[[str], str] = str
    """Function that returns the name of a file in messages."""


@dataclass(slots=True)
class Declared:
    """An argument that a launch file declares."""

    name: str
    default: str | None
    choices: tuple[str, ...]
    place: Span


@dataclass(slots=True)
class Expansion:
    """Nodes that a launch file starts, with certain values of its arguments."""

    arguments: Mapping[str, str | None]
    """Values that differ from the defaults."""
    nodes: list[StartedNode] = field(default_factory=list)
    findings: list[Diagnostic] = field(default_factory=list)
    declared: dict[str, Declared] = field(default_factory=dict)
    used: dict[str, None] = field(default_factory=dict)
    """Arguments on which conditions depend, in the order of their use."""
    compared: dict[str, dict[str, None]] = field(default_factory=dict)
    """Texts with which conditions and expressions compare arguments, by the name of the argument."""
    runs_programs: bool = False
    """True if programs run that are no nodes of a package, whose topics are not known."""
    undeclared: list[tuple[str, Span]] = field(default_factory=list)
    """Arguments that are used, and that no launch file declares, with the places of their use."""
    skipped: dict[str, Span] = field(default_factory=dict)
    """Packages of which launch files are included, but not there."""
    absent: dict[str, Span] = field(default_factory=dict)
    """Packages whose share folders are used, and that are not there, with the places of their use."""
    dependencies: set[str] = field(default_factory=set)
    """Packages that the manifests of the launch files' packages name."""
    included: set[str] = field(default_factory=set)
    """Paths of the launch files that were expanded to their end."""
    unevaluated: set[str] = field(default_factory=set)
    """Paths of launch files whose actions are not known, or not all of them."""
    of_ros1: set[str] = field(default_factory=set)
    """Paths of launch files that only ROS 1 reads."""


class Expander:
    """Expands launch files; remembers the files that it has read."""

    def __init__(
        self,
        packages: Packages,
        shown: Callable[[str], str],
        stored: Mapping[tuple[str, str], Any],
        known: Collection[str],
        limits: Limits = DEFAULT_LIMITS,
        environment: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        """``shown`` returns the name of a file in messages.

        ``stored`` are descriptions of launch files, by their packages and paths. ``known`` are packages of which it is
        no news that they are not there. ``limits`` are those of the processes in which launch files run.
        ``environment`` has the variables that the rover's computer is known to have.
        """
        self._packages, self._stored, self.known = packages, stored, known
        # Not a method: the nodes have this function, and go from process to process.
        self.shown = shown
        self._limits, self.environment = limits, environment
        self._declarative: dict[str, tuple[list[Action], list[Diagnostic]]] = {}
        self._python: dict[str, PythonFile] = {}
        self._parameter_files: dict[str, ParameterFile] = {}
        self._expected: Iterator[tuple[Path, Mapping[str, str]]] = iter(())
        self._begun: dict[Path, Iterator[Expansion]] = {}

    def expect(self, paths: Iterable[Path], arguments: Mapping[str, str]) -> None:
        """Expand launch files ahead, in the order in which `variants` will be asked for them."""
        self._expected = ((path.resolve(), arguments) for path in paths)

    def variants(self, path: Path, arguments: Mapping[str, str]) -> list[Expansion]:
        """Return what a launch file starts with some values of its arguments, and with others beside them.

        The first one has the defaults of all other arguments, then each of these has another value once (see
        `variations`). The launch file runs in a child process. Raises `UnreadableFileError`.
        """
        found: list[Expansion] = []
        path = path.resolve()  # the child has another working folder
        place = Span(self.shown(str(path)))
        for expected, given in itertools.islice(self._expected, max(0, AT_ONCE - len(self._begun))):
            self._begun[expected] = started(partial(self._variants, expected, given), self._limits)
        begun = self._begun.pop(path, None) or started(partial(self._variants, path, arguments), self._limits)
        try:
            for expansion in begun:
                found.append(expansion)
        except ChildEndedError as error:
            if not (found or isinstance(error, ChildWaitsError)):
                raise UnreadableFileError(place, f"the file cannot be evaluated: {error}") from error
            part = " with all values of its arguments" if found else ""
            if not found:  # it waits for a device or a program, which may be there on the robot
                found.append(Expansion(dict(arguments), unevaluated={str(path)}))
            found[0].findings.append(NotExpanded.at(place, f"the file cannot be evaluated{part}: {error}"))
        return found

    def _variants(self, path: Path, arguments: Mapping[str, str]) -> Iterator[Expansion]:
        self._packages.prefer(path)
        first = self.expand(path, arguments)
        others = list(itertools.islice(variations(first), _MOST_VARIATIONS + 1))
        if len(others) > _MOST_VARIATIONS:
            message = f"the arguments have many values; the file is checked with {_MOST_VARIATIONS} of them"
            first.findings.append(NotExpanded.at(Span(self.shown(str(path))), message))
        yield first
        for values in others[:_MOST_VARIATIONS]:
            yield self.expand(path, {**arguments, **values})

    def expand(self, path: Path, arguments: Mapping[str, str | None]) -> Expansion:
        """Return what a launch file starts with some values of its arguments, in this process.

        Raises `UnreadableFileError`.
        """
        run, file = _Run(self, self._packages, arguments), str(path.resolve())
        run.context.file = file
        try:
            run.include(file, Span(self.shown(file)))
        except (TooLongTextError, RecursionError) as error:
            reason = f"grows without end: {error}" if isinstance(error, TooLongTextError) else "is nested too deeply"
            place = run.context.place if run.context.place.file else Span(self.shown(file))
            raise UnreadableFileError(place, f"the launch file {reason}") from error
        # What starts later may use an argument that is declared behind it.
        later = (one for one in run.undeclared_later if one[0] not in run.result.declared)
        undeclared = dict.fromkeys((*run.context.undeclared, *later))
        run.result.undeclared = [one for one in undeclared if one[0] not in run.without_default]
        run.result.absent |= run.context.absent
        return run.result

    def actions(self, path: str) -> tuple[list[Action], list[Diagnostic]]:
        """Return the actions of a launch file. Raises `UnreadableFileError`, `NeedsMoreError` or `OfRos1Error`."""
        if path not in self._declarative:
            if is_python(Path(path)):
                return self.python(path).actions(), []
            self._declarative[path] = read_declarative(Path(path), self.shown(path))
        return self._declarative[path]

    def absent(self, path: str) -> Mapping[str, Span]:
        """Return the packages that a Python launch file has asked for, and that are not there, each with its place."""
        return self._python[path].absent if path in self._python else {}

    def missing_modules(self, path: str) -> Iterator[tuple[str, Span]]:
        """Yield the modules that a Python launch file has imported, and that are not there, each with its place."""
        return self._python[path].missing_modules() if path in self._python else iter(())

    def python(self, path: str) -> PythonFile:
        """Return a Python launch file. Raises `UnreadableFileError`."""
        if path not in self._python:
            self._python[path] = PythonFile(Path(path), self.shown(path), self._packages, self.environment)
        return self._python[path]

    def sections(
        self, path: str, shown: str, text_of: Callable[[str], str | None] | None, of_component: bool
    ) -> list[Section]:
        """Return the sections of a parameter file (see `ParameterFile.sections`). Raises `UnreadableFileError`."""
        if path not in self._parameter_files:
            self._parameter_files[path] = ParameterFile(Path(path), shown)
        return self._parameter_files[path].sections(text_of, of_component)

    def refused(self, path: str) -> tuple[str, Span] | None:
        """Return message and place of what ROS 2 refuses in a parameter file whose sections were read."""
        return self._parameter_files[path].refused

    def stored(self, package: str, path: str) -> Any:
        """Return the description of a launch file that is not there; None if there is none."""
        return self._stored.get((package, path))

    def stored_files(self, package: str) -> list[str]:
        """Return the paths of the launch files of a package that have descriptions."""
        return [path for name, path in self._stored if name == package]


class EndlessExpansionError(UnreadableFileError):
    """Raised for launch files that include so many others, or start so many nodes, that the expansion may not end."""


class _Run:
    """One expansion."""

    def __init__(self, expander: Expander, packages: Packages, arguments: Mapping[str, str | None]) -> None:
        self._expander = expander
        self.context = Context(packages, dict(arguments), dict(expander.environment))
        self.result = Expansion(dict(arguments))
        self._depth = self._includes = 0
        self._skips = 0  # includes of files that are not here, and parts that are switched off
        self._path = ""  # path of the launch file whose actions are expanded
        self._included_at = Span("")  # place of the include of that file
        self.without_default: set[str] = set()
        """Arguments of the launch file itself of which the default is their own value: the user has to give it."""
        self.undeclared_later: list[tuple[str, Span]] = []
        """Arguments that are not declared where something uses them that starts later, with the places."""

    def include(self, path: str, place: Span) -> None:
        """Expand the actions of a launch file."""
        self._depth += 1
        self._includes += 1
        if self._depth > _DEEPEST:
            raise EndlessExpansionError(place, "launch files include each other without end")
        if self._includes > _MOST_INCLUDES:
            raise EndlessExpansionError(place, f"launch files are included more than {_MOST_INCLUDES} times")
        before, self._path, self._included_at = (self._path, self._included_at), path, place
        try:
            actions, findings = self._actions(path, place)
            self.result.findings += findings
            self.result.dependencies |= self.context.packages.dependencies(path)
            self._run(actions)
            self.result.included.add(path)
        finally:
            self._path, self._included_at = before
            self._depth -= 1

    def _actions(self, path: str, place: Span) -> tuple[list[Action], list[Diagnostic]]:
        if missing := package_of_share(path):
            package, inner = missing
            stored = self._expander.stored(package, inner)
            if stored is None:
                self._skips += 1
                self.result.skipped.setdefault(package, place)
                near = misspelt(inner, self._expander.stored_files(package))
                message = f"the package '{package}' has no launch file '{inner}'"
                return [], [UnreadableLaunchFile.at(place, message, did_you_mean(near))] if near else []
            return actions_of_stored(stored, place), []
        try:
            actions, findings = self._expander.actions(path)
        except NeedsMoreError as error:
            self._note_missing(path)
            self.result.unevaluated.add(path)
            return [], [NotExpanded.at(error.place, str(error))]
        except OfRos1Error as error:
            self.result.of_ros1.add(path)
            message = f"this is a launch file of ROS 1, with '{error}'; `ros2 launch` refuses it"
            finding = UnknownAction.at(error.place, message, _FROM_ROS1)
            is_meant = "catkin" in self.context.packages.dependencies(path)
            return [], [as_hint(finding) if is_meant else finding]
        self._note_missing(path)
        if any(finding.severity is Severity.HINT for finding in findings):  # of an action that is not known
            self.result.unevaluated.add(path)
        return actions, findings

    def _note_missing(self, path: str) -> None:
        """Note the packages, and report the modules that a Python launch file uses, and that are not there."""
        self.result.absent |= self._expander.absent(path)
        for module, place in self._expander.missing_modules(path):
            message = f"the file imports '{module}', which is not installed; what it gives is not checked"
            finding = NotExpanded.at(place, message)
            if finding not in self.result.findings:
                self.result.findings.append(finding)
            self.result.runs_programs = True

    def _run(self, actions: Iterable[Action]) -> None:
        for action in actions:
            self.context.place = action.place
            for option, near in action.unknown_options.items():
                finding = UnknownAction.at(action.place, f"the action has no option '{option}'", did_you_mean(near))
                is_old = option in stated_facts().renamed_options
                self.result.findings.append(OldName.of(finding) if is_old else finding)
            if self._holds(action):
                self._one(action)
            elif isinstance(action, Include | Group | Opaque):
                self._skips += 1  # what is there with other values may declare more arguments

    def _holds(self, action: Action) -> bool:
        """Return true if the condition of an action holds, or if it is not known."""
        if action.condition is None:
            return True
        wanted, text = action.condition
        self._note_use(text, is_condition=True)
        try:
            value = text_of(text, self.context)
            if not is_boolean(value):
                self._report(
                    WrongArgumentValue, action.place, f"the condition is '{value}', which is neither true nor false"
                )
                return True
            return is_true(value) == wanted
        except UnknownTextError:
            return True

    def _note_use(self, text: Any, is_condition: bool) -> None:
        """Remember the arguments on which it depends what starts."""
        for name, compared in _arguments_in(text, is_condition):
            self.result.used[name] = None
            if compared is not None:
                self.result.compared.setdefault(name, {})[compared] = None

    def _report(self, rule: type[Rule], place: Span, message: str, help: str = "") -> None:
        self.result.findings.append(rule.at(place, message, help))

    def _text(self, value: Any) -> str | None:
        """Return a text; None if it is known at run time only."""
        if value is None:
            return ""
        self._note_use(value, is_condition=False)
        try:
            return text_of(value, self.context)
        except UnknownTextError:
            return None

    def _path_of_file(self, value: Any) -> str | None:
        """Return the text of a path; what a file says depends on the arguments in its path."""
        self._note_use(value, is_condition=True)
        return self._text(value)

    def _one(self, action: Action) -> None:
        context = self.context
        if isinstance(action, DeclareArgument):
            self._declare(action)
        elif isinstance(action, SetConfiguration):
            if name := self._text(action.name):
                context.configurations[name] = self._text(action.value)
        elif isinstance(action, SetEnvironment):
            name, value = self._text(action.name), self._text(action.value)
            if name and value is not None:
                context.environment[name] = value
        elif isinstance(action, Group):
            self._group(action)
        elif isinstance(action, PushNamespace):
            pushed = self._text(action.namespace)
            context.namespace = joined(context.namespace, pushed) if pushed is not None else context.namespace
        elif isinstance(action, SetRemap):
            remapping = StartedRemapping(
                self._text(action.source), self._text(action.target), action.place, action.place, True
            )
            context.remappings = [*context.remappings, remapping]
        elif isinstance(action, SetParameter):
            context.parameters = [*context.parameters, *self._values(action.name, action.value, action.place, False)]
        elif isinstance(action, SetParametersFromFile):
            context.parameters = [*context.parameters, self._file(GivenFile(action.path, action.place))]
        elif isinstance(action, Include):
            self._include(action)
        elif isinstance(action, StartNode):
            self._start(action)
        elif isinstance(action, LoadNodes):
            if action.container:
                self._start(action.container)
            self._run(action.nodes)
        elif isinstance(action, Execute):
            self.result.runs_programs = True
        elif isinstance(action, Opaque):
            self._call(action)
        elif isinstance(action, Later):
            before = len(context.undeclared)
            self._run(action.actions)
            self.undeclared_later += context.undeclared[before:]
            del context.undeclared[before:]

    def _declare(self, action: DeclareArgument) -> None:
        name = self._text(action.name)
        if not name:
            return
        before = len(self.context.undeclared)
        default = self._text(action.default) if action.default is not None else None
        if self._depth == 1 and any(used == name for used, _ in self.context.undeclared[before:]):
            self.without_default.add(name)
        self.result.declared.setdefault(name, Declared(name, default, action.choices, action.place))
        is_needed = action.default is None and action.condition is None and not package_of_share(self._path)
        if is_needed and self._depth > 1 and name not in self.context.configurations:
            message = f"the included launch file needs the argument '{name}', which has no value"
            self._report(UndeclaredArgument, self._included_at, message)
        value = self.context.configurations.setdefault(name, default)
        if action.choices and value is not None and value not in action.choices:
            known = ", ".join(action.choices)
            self._report(
                WrongArgumentValue, action.place, f"the argument '{name}' is '{value}'; it must be one of: {known}"
            )

    def _group(self, action: Group) -> None:
        context = self.context
        saved = (
            dict(context.configurations),
            dict(context.environment),
            context.namespace,
            context.remappings,
            context.parameters,
        )
        for name, value in action.configurations.items():
            if text := self._text(name):
                context.configurations[text] = self._text(value)
        self._run(action.actions)
        if action.scoped:
            context.configurations, context.environment, context.namespace, context.remappings, context.parameters = (
                saved
            )

    def _include(self, action: Include) -> None:
        """Set the arguments and expand the included file.

        `$(dirname)` is the folder of the included file already in the values of the arguments, and still in the actions
        after the include: IncludeLaunchDescription of `launch` sets it first, and does not restore it.
        """
        path = self._path_of_file(action.path)
        if path is not None:
            self.context.file = path = self._absolute(path)
        for name, value, place in action.arguments:
            if text := self._text(name):
                if isinstance(value, bool | int | float):
                    message = f"the argument '{text}' is {value}, which is no text: `launch` stops with an error"
                    self._report(WrongArgumentValue, place, message, f"write '{value}' with quotation marks")
                self.context.configurations[text] = self._text(value)
        if path is None:
            self._report(NotExpanded, action.place, "the path of an included launch file is known at run time only")
            return
        before = set(self.result.declared)
        findings, skips = len(self.result.findings), self._skips
        if self._is_elsewhere(path):
            self._report(NotExpanded, action.place, f"'{path}' is a file of another computer; it is not checked")
            return
        try:
            self.include(path, action.place)
        except EndlessExpansionError:
            raise
        except UnreadableFileError as error:
            place = error.place if error.place.line else action.place
            self._report(
                UnreadableLaunchFile,
                place,
                f"{self._expander.shown(path)}: {error}" if place == action.place else str(error),
            )
            return
        missing = package_of_share(path)
        unread = self.result.unevaluated | self.result.of_ros1
        is_complete = len(self.result.findings) == findings and path not in unread and self._skips == skips
        for name, _, place in action.arguments:
            text = self._text(name)
            if (
                text
                and is_complete
                and text not in self.result.declared
                and text not in before
                and not self._is_used(path, text)
            ):
                shown = self._expander.shown(path) if missing is None else f"{missing[1]} of {missing[0]}"
                new = stated_facts().new_name(text, self.result.declared.__contains__)
                near = all_nearest(text, self.result.declared, 0.8)
                near = near or [name for name in self.result.declared if name.startswith(f"{text}_")]
                help = f"it is now '{new}'" if new else did_you_mean(near if len(near) <= _MOST_MEANT else [])
                finding = UndeclaredArgument.at(place, f"{shown} has no argument '{text}'", help)
                self.result.findings.append(as_warning(finding))

    def _absolute(self, path: str) -> str:
        """Return the path of a file; one in the share folder of a package that is there becomes that of the package."""
        if found := package_of_share(path):
            share = self.context.packages.share(found[0])
            return path if package_of_share(share) else self.context.packages.existing(os.path.join(share, found[1]))
        return self.context.packages.existing(path, os.path.dirname(self._path))

    def _is_elsewhere(self, path: str) -> bool:
        """Return true for a file that is not here, and that is not one of the checked packages."""
        return not package_of_share(path) and not os.path.exists(path) and not self.context.packages.holds(path)

    def _is_used(self, path: str, name: str) -> bool:
        """Return true if a launch file names an argument anywhere, such as in a function that adds more arguments."""
        if package_of_share(path):
            return False
        try:
            return name in bounded_files.read(path).decode(errors="replace")
        except OSError:
            return True

    def _call(self, action: Opaque) -> None:
        if missing := package_of_share(self._path):
            self.result.skipped.setdefault(missing[0], action.place)
            return
        try:
            if is_python(Path(self._path)):
                actions = self._expander.python(self._path).called(action.function, self.context)
                self._note_missing(self._path)
                self._run(actions)
        except NeedsMoreError as error:
            self.result.unevaluated.add(self._path)
            self._report(NotExpanded, error.place, str(error))

    def _start(self, action: StartNode) -> None:
        context = self.context
        self.context.place = action.place
        namespace = self._text(action.namespace) if action.namespace is not None else ""
        values: list[GivenValue] = []
        files: list[FileUse] = []
        has_unknown_files = None in context.parameters
        for given in action.parameters:
            if isinstance(given, GivenParameter):
                values += self._values(given.name, given.value, given.place, given.is_text)
            elif use := self._file(given, of_component=bool(action.plugin)):
                files.append(use)
            else:
                has_unknown_files = True
        arguments = [self._text(argument) for argument in action.arguments]
        if isinstance(action.arguments, str) and len(action.arguments) > 1:
            message = "'arguments' is one text, of which each letter becomes a word: `launch` takes a list of words"
            help = f"write {action.arguments.split()}"
            self.result.findings.append(as_warning(UnknownAction.at(action.place, message, help)))
        remappings = [
            StartedRemapping(
                self._text(remapping.source), self._text(remapping.target), remapping.place, remapping.target_place
            )
            for remapping in action.remappings
        ]
        name = self._text(action.name) if action.name is not None else ""
        for option, value in _of_ros([*arguments, "--ros-args", *map(self._text, action.ros_arguments)]):
            before, is_pair, after = value.partition(":=")
            if option == "--params-file":
                use = self._file(GivenFile(value, action.place))
                files += [use] if use else []
                has_unknown_files |= use is None
            elif option in ("-r", "--remap") and is_pair:
                remappings.append(StartedRemapping(before, after, action.place, action.place))
            elif option in ("-p", "--param") and is_pair:
                values.insert(0, GivenValue(before, typed(after), action.place))
        for rule in remappings:
            if rule.source in ("__node", "__name"):
                name = rule.target
            elif rule.source == "__ns":
                namespace = rule.target
        remappings = [rule for rule in remappings if not (rule.source or "").startswith("__")]
        self._check_names(action, name, namespace, remappings)
        if len(self.result.nodes) >= _MOST_NODES:
            raise EndlessExpansionError(action.place, f"the launch file starts more than {_MOST_NODES} nodes")
        general = [given for given in context.parameters if isinstance(given, GivenValue)]
        files = [*(given for given in context.parameters if isinstance(given, FileUse)), *files]
        self.result.nodes.append(
            StartedNode(
                action.place,
                self._text(action.package),
                self._text(action.executable),
                self._text(action.plugin),
                name,
                joined(context.namespace, namespace) if namespace is not None else None,
                tuple(values),
                tuple(general),
                tuple(files),
                (*context.remappings, *remappings),
                tuple(arguments),
                has_unknown_files,
                self._expander.shown,
            )
        )

    def _check_names(
        self, action: StartNode, name: str | None, namespace: str | None, remappings: Iterable[StartedRemapping]
    ) -> None:
        """Report names that ROS 2 refuses (rmw/validate_node_name.h and validate_namespace.h, rcl/remap.h)."""
        names = [("node", name, _WRONG_NODE, action.place), ("namespace", namespace, _WRONG_TOPIC, action.place)]
        names += [("topic", rule.target, _WRONG_TOPIC, rule.target_place) for rule in remappings]
        for kind, text, wrong, place in names:
            if text and (match := wrong.search(text)):
                reason = "a part begins with a digit" if match[0].lstrip("/").isdigit() else f"it contains '{match[0]}'"
                help = f"write '{re.sub(r'[^A-Za-z0-9_/~]', '_', text)}'" if "digit" not in reason else ""
                finding = InvalidName.at(place, f"ROS 2 refuses '{text}' as the name of a {kind}: {reason}", help)
                self.result.findings.append(as_hint(finding) if "$" in text else finding)  # perhaps of a template

    def _values(self, name: Any, value: Any, place: Span, is_text: bool) -> Iterator[GivenValue]:
        text = self._text(name)
        if text is None:
            return
        if isinstance(value, Mapping):
            for inner, inner_value in value.items():
                yield from self._values([name, ".", inner], inner_value, place, is_text)
            return
        yield GivenValue(text, self._value(value, is_text), place)

    def _value(self, value: Any, is_text: bool) -> Any:
        """Return a parameter's value as launch_ros types it: the text of substitutions is read as YAML."""
        if isinstance(value, str):
            return UNKNOWN if RUN_TIME in value else dumped(str(value))  # not a class of the launch file
        for kind in (bool, int, float):
            if isinstance(value, kind):
                return kind(value)
        if isinstance(value, list | tuple) and not any(hasattr(part, "perform") for part in value):
            values: list[Any] = [
                self._value(part, False) if not isinstance(part, list | tuple) else self._text(part) for part in value
            ]
            if {type(part) for part in values} == {int, float}:
                return [float(part) for part in values]
            return UNKNOWN if any(part is UNKNOWN or part is None for part in values) else values
        text = self._text(value)
        if text is None:
            return UNKNOWN
        return text if is_text or not text else typed(text)  # also a text of a YAML or XML launch file

    def _file(self, given: GivenFile, of_component: bool = False) -> FileUse | None:
        text = self._path_of_file(given.path)
        if not text:
            return None
        path = self._absolute(text)
        if missing := package_of_share(path):
            if missing[0] not in self._expander.known:
                self.result.skipped.setdefault(missing[0], given.place)
            return None
        shown = self._expander.shown(self.context.sources.get(path, path))
        if self._is_elsewhere(path):
            self._report(NotExpanded, given.place, f"'{path}' is a file of the robot; its parameters are not checked")
            return None
        if os.path.isdir(path) and any(_arguments_in(given.path, is_condition=True)):
            self._report(NotExpanded, given.place, f"'{text}' is a folder; an argument has to name a file of it")
            return None
        if os.path.isdir(path) or not os.path.exists(path):  # launch_ros/actions/node.py asks for a file
            if not os.path.isabs(text) and text.endswith((".yaml", ".yml")):
                message = f"'{text}' is relative to the folder in which `ros2 launch` runs; it is not checked"
                self._report(NotExpanded, given.place, message)
                return None
            missing_file = shown if os.path.isabs(text) else f"'{text}'"
            help = "" if os.path.splitext(text)[1] else "a text is the path of a file; parameters are {'name': value}"
            self._report(MissingFile, given.place, f"the parameter file {missing_file} is not there", help)
            return None
        try:
            text_of = self._file_text if given.has_substitutions else None
            sections = self._expander.sections(path, shown, text_of, of_component)
        except UnreadableFileError as error:
            place = error.place if error.place.line else given.place
            self._report(UnreadableLaunchFile, place, str(error) if error.place.line else f"{shown}: {error}")
            return None
        # A file that the launch file makes has another name each time.
        if self.context.packages.is_temporary(path) and path not in self.context.sources:
            shown, sections = self._expander.shown(self._path), [section.at(given.place) for section in sections]
        refused = self._expander.refused(path)
        if refused and given.rewrites is None and not of_component:
            self._report(UnreadableLaunchFile, refused[1], refused[0])
        rewrites: dict[str, Any] = {}
        for name, value in (given.rewrites or {}).items():
            if (parameter := self._text(name)) is not None:
                text = self._text(value)
                rewrites[parameter] = UNKNOWN if text is None else typed(text) if text else ""
        namespace = self._text(given.root_key) or ""
        return FileUse(given.place, shown, tuple(rewritten(sections, namespace, rewrites)))

    def _file_text(self, text: str) -> str | None:
        try:
            return self._text(parse_text(text))
        except WrongTextError:
            return None


def _of_ros(words: Iterable[str | None]) -> Iterator[tuple[str, str]]:
    """Yield the options of ROS 2 in a command line with their values: ``--ros-args -r old:=new``."""
    is_of_ros = False
    for option, value in itertools.pairwise(words):
        is_of_ros = option == "--ros-args" or (is_of_ros and option != "--")
        if is_of_ros and option is not None and value is not None:
            yield option, value


def joined(namespace: str, pushed: str) -> str:
    """Return a namespace with another one in it; an absolute one replaces it."""
    if not pushed:
        return namespace
    return pushed.rstrip("/") if pushed.startswith("/") else f"{namespace}/{pushed.strip('/')}"


_COMPARED = re.compile("\0(\\w+)\0['\"]?\\s*[!=]=\\s*['\"]([^'\"]*)['\"]")


def _arguments_in(text: Any, is_condition: bool) -> Iterator[tuple[str, str | None]]:
    """Yield the names of the arguments in conditions and expressions, and the texts that they are compared with."""
    if isinstance(text, str | Ignored):
        return
    if isinstance(text, list | tuple):
        for part in text:
            yield from _arguments_in(part, is_condition)
    elif isinstance(text, PythonExpression):
        parts = list(_flat(text.expression))
        yield from _arguments_in(parts, True)
        flat = "".join(
            f"\0{part.variable_name}\0" if isinstance(part, LaunchConfiguration) else str(part) for part in parts
        )
        yield from ((match[1], match[2]) for match in _COMPARED.finditer(flat))
    elif isinstance(text, LaunchConfiguration):
        if is_condition and isinstance(text.variable_name, str):
            yield text.variable_name, None
    elif isinstance(text, EqualsSubstitution):
        for side, other in ((text.left, text.right), (text.right, text.left)):
            if isinstance(side, LaunchConfiguration) and isinstance(side.variable_name, str):
                yield side.variable_name, other if isinstance(other, str) else None
    else:
        for name in ("left", "right", "value", "condition", "expression"):
            if hasattr(text, name):
                yield from _arguments_in(getattr(text, name), True)


def _flat(text: Any) -> Iterator[Any]:
    if isinstance(text, list | tuple):
        for part in text:
            yield from _flat(part)
    else:
        yield text


def variations(expansion: Expansion) -> Iterator[dict[str, str | None]]:
    """Yield values of arguments, one argument at a time, that may start other nodes than the defaults do.

    None stands for any value but the default.
    """
    for name in expansion.used:
        declared = expansion.declared.get(name)
        if declared is None or name in expansion.arguments:
            continue
        if declared.choices:
            others: list[str | None] = [choice for choice in declared.choices if choice != declared.default]
        elif declared.default is not None and is_boolean(declared.default):
            others = [_opposite(declared.default)]
        else:
            compared = expansion.compared.get(name, {})
            others = [value for value in compared if value != declared.default] or [None] * bool(compared)
        yield from ({name: value} for value in others)


def _opposite(text: str) -> str:
    pairs = {"true": "false", "false": "true", "True": "False", "False": "True", "1": "0", "0": "1"}
    return pairs.get(text, "false")
