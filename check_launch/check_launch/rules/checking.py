"""Check of launch files and parameter files with all rules."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path

from check_launch.catalogue.facts import OWN_SOURCE, Catalogue
from check_launch.expansion.child_process import DEFAULT_LIMITS, Limits
from check_launch.expansion.entities import UnreadableFileError, is_declarative, text_of_file
from check_launch.expansion.expander import Expander, Expansion
from check_launch.expansion.launch_context import Packages
from check_launch.expansion.parameter_files import NoParametersError, ParameterFile, is_parameter_file
from check_launch.expansion.python_files import is_launch_program, is_python
from check_launch.expansion.source_trees import source_folders
from check_launch.misspellings import all_nearest, did_you_mean, misspelt
from check_launch.rules.frame_findings import frame_findings
from check_launch.rules.launch_rules import (
    MisplacedParameter,
    MissingFile,
    MisspeltPackage,
    NotExpanded,
    TopicFromOutside,
    UndeclaredArgument,
    UnknownAction,
    UnknownParameter,
    UnreadableLaunchFile,
    as_hint,
    as_warning,
)
from check_launch.rules.node_findings import node_findings
from check_launch.rules.parameter_findings import parameter_findings, used_parameters
from check_launch.rules.section_findings import Sections
from check_launch.rules.system import System, Variants, system_of
from check_launch.rules.topic_findings import ends_of, topic_findings, used_remappings
from roverlink import bounded_files
from roverlink.generator.diagnostics import Diagnostic, Severity, Span, in_order
from roverlink.numerals import counted

LAUNCH_ENDINGS = ("launch.py", "launch.xml", "launch.yaml", "launch.yml", ".launch")
_OF_ONE_NODE = (UnknownParameter, MisplacedParameter)
_COMPLETE = re.compile(r"^[ \t]*(?:#|<!--)[ \t]*check-launch: complete\b", re.MULTILINE)
"""Comment in a launch file that starts everything."""


@dataclass(slots=True)
class Checked:
    """Result of a check."""

    distribution: str
    """Distribution of the catalogue."""
    findings: list[Diagnostic] = field(default_factory=list)
    systems: list[tuple[str, System]] = field(default_factory=list)
    """System that each launch file starts with the defaults of its arguments, by the name of the file."""
    launch_files: set[str] = field(default_factory=set)
    """Paths of the launch files that were to be checked."""
    evaluated: set[str] = field(default_factory=set)
    """Paths of launch files that were evaluated to their end, by themselves or as parts of others."""
    of_ros1: set[str] = field(default_factory=set)
    """Paths of launch files that only ROS 1 reads."""
    declared: set[str] = field(default_factory=set)
    """Arguments that the launch files declare."""
    undeclared: set[Span] = field(default_factory=set)
    """Places where launch files use arguments that they do not declare."""
    used: set[Span] = field(default_factory=set)
    """Places of parameters that a node of a launch file has."""
    parameter_files: int = 0
    read: int = 0
    """Parameter files with a section of a node that the catalogue knows."""

    @property
    def extent(self) -> str:
        """Text about the files that the check has evaluated, and about those that it has not."""
        parts = []
        if of_ros2 := self.launch_files - self.of_ros1:
            parts.append(f"{len(self.evaluated & of_ros2)} of {counted(len(of_ros2), 'launch file')} evaluated")
        if of_ros1 := self.launch_files & self.of_ros1:
            parts.append(f"{counted(len(of_ros1), 'launch file')} of ROS 1")
        if unread := self.parameter_files - self.read:
            parts.append(f"{unread} of {counted(self.parameter_files, 'parameter file')} not checked")
        elif self.parameter_files:
            parts.append(f"{counted(self.parameter_files, 'parameter file')} checked")
        parts.append(f"with the catalogue of {self.distribution}")
        return ", ".join(parts)


class Checker:
    """Checks files with the facts of a catalogue."""

    def __init__(
        self, catalogue: Catalogue, packages: Packages, complete: bool = False, limits: Limits = DEFAULT_LIMITS
    ) -> None:
        """``packages`` are those of the source trees; ``complete`` says that each launch file starts everything.

        ``limits`` are those of the processes in which launch files run.
        """
        self._catalogue, self._complete = catalogue, complete
        stored = {
            (name, path): actions
            for name, package in catalogue.packages.items()
            for path, actions in package.launch_files.items()
        }
        self._own = {name for name, package in catalogue.packages.items() if package.source == OWN_SOURCE}
        self._known = [
            (endpoint.kind, endpoint.name)
            for package in catalogue.packages.values()
            if package.source == OWN_SOURCE
            for class_name in package.executables.values()
            if class_name in catalogue.classes
            for endpoint in catalogue.classes[class_name].endpoints
        ]
        # Launch files may change the current folder of the process in which they run.
        shown = partial(shown_path, start=os.getcwd())
        environment = {"ROS_DISTRO": catalogue.distribution, "ROS_VERSION": "2"}
        self._expander = Expander(packages, shown, stored, catalogue.packages, limits, environment)

    def check(self, files: Iterable[Path], arguments: Mapping[str, str]) -> Checked:
        """Check launch files with some values of their arguments, and parameter files."""
        checked, paths = Checked(self._catalogue.distribution), list(files)
        sections = Sections(self._catalogue)
        launch_files = [path for path in paths if _is_launch_file(path)]
        checked.launch_files = {str(path.resolve()) for path in launch_files}
        parameter_files = {shown_path(str(path)): path for path in paths if path not in launch_files}
        self._expander.expect(launch_files, arguments)
        for path in launch_files:
            try:
                self._check_launch_file(path, arguments, checked, sections)
            except UnreadableFileError as error:
                checked.findings.append(UnreadableLaunchFile.at(error.place, str(error)))
        alone = {shown: path for shown, path in parameter_files.items() if shown not in sections.files}
        others = self._with_loaders(alone, sections)
        checked.findings += [one for one in others if one.span.file in alone and one.rule.id[:3] in ("PAR", "PLG")]
        checked.findings += [*sections.findings(), *_unknown_arguments(arguments, launch_files, checked)]
        for shown, path in alone.items():
            try:
                if shown not in sections.files:
                    found = ParameterFile(path, shown).sections(_known_text)
                    checked.findings += sections.standalone(found, shown, is_unused=bool(launch_files))
            except UnreadableFileError as error:
                unreadable = UnreadableLaunchFile.at(error.place, str(error))
                # A file that no launch file gives to a node may be a template, or have another meaning.
                is_certain = not launch_files and not isinstance(error, NoParametersError)
                checked.findings.append(unreadable if is_certain else as_hint(unreadable))
        # A file for several nodes may serve those of several launch files.
        kept = [one for one in checked.findings if one.span not in checked.used or one.rule not in _OF_ONE_NODE]
        of_others = sections.of_others
        kept = [as_hint(one) if one.span in of_others and one.rule in _OF_ONE_NODE else one for one in kept]
        checked.findings = [
            _of_included(one, launch_files)
            if one.span in checked.undeclared and one.rule is UndeclaredArgument
            else one
            for one in kept
        ]
        checked.parameter_files = len(parameter_files)
        checked.read = len(sections.read_files & set(parameter_files))
        checked.findings = in_order(_once(checked.findings))
        return checked

    def _with_loaders(self, alone: Mapping[str, Path], sections: Sections) -> list[Diagnostic]:
        """Expand the YAML and XML launch files beside parameter files that give these to nodes; return their findings.

        Python launch files are left out: they are programs, and nobody has asked for them.
        """
        checked = Checked(self._catalogue.distribution)
        for path in sorted({loader for file in alone.values() for loader in _loaders(file)}):
            with suppress(UnreadableFileError):
                self._check_launch_file(path, {}, checked, sections, set(alone))
        return checked.findings

    def _check_launch_file(
        self,
        path: Path,
        arguments: Mapping[str, str],
        checked: Checked,
        sections: Sections,
        wanted: Collection[str] | None = None,
    ) -> None:
        """Check a launch file; with ``wanted``, only if it gives one of these parameter files to a node."""
        expansions = self._expander.variants(path, arguments)
        systems = [system_of(expanded, self._catalogue, expanded is not expansions[0]) for expanded in expansions]
        if wanted is not None and not any(
            use.shown in wanted for system in systems for node in system.nodes for use in node.started.files
        ):
            return
        checked.systems.append((shown_path(str(path)), systems[0]))
        # An expansion with any value of an argument, None, adds to what the default and the known values start.
        known_values = [expanded for expanded in expansions if None not in expanded.arguments.values()]
        unevaluated = set().union(*(expanded.unevaluated for expanded in known_values))
        checked.of_ros1 |= set().union(*(expanded.of_ros1 for expanded in expansions))
        checked.evaluated |= set().union(*(expanded.included for expanded in expansions)) - unevaluated
        for system in systems:
            sections.add(system)
        variants = Variants(
            frozenset().union(*map(used_parameters, systems)),
            frozenset().union(*map(used_remappings, systems)),
            frozenset().union(*map(ends_of, systems)),
        )
        checked.used |= {place for _, place in variants.parameters}
        complete = self._complete or _COMPLETE.search(text_of_file(path, shown_path(str(path)))) is not None
        known: set[tuple[object, ...]] = set()
        for expanded, system in zip(expansions, systems, strict=True):
            varied = ((name, value) for name, value in expanded.arguments.items() if name not in arguments)
            chosen = " ".join(f"{name}:={'...' if value is None else value}" for name, value in varied)
            checked.undeclared |= {place for _, place in expanded.undeclared}
            checked.declared |= {*expanded.declared}
            for finding in self._of_expansion(expanded, system, variants, complete, bool(chosen)):
                if _key(finding) in known or (chosen and finding.severity is Severity.HINT):
                    continue
                known.add(_key(finding))
                checked.findings.append(
                    replace(finding, message=f"{finding.message} (with {chosen})") if chosen else finding
                )

    def _of_expansion(
        self, expansion: Expansion, system: System, variants: Variants, complete: bool, is_varied: bool
    ) -> Iterator[Diagnostic]:
        yield from expansion.findings
        for name, place in expansion.undeclared:
            message = f"the argument '{name}' is not declared"
            help = "declare it with `arg`, above its first use"
            yield as_warning(UndeclaredArgument.at(place, message, help))  # a user may give it
        for package, place in {**expansion.absent, **expansion.skipped}.items():
            known = {*self._catalogue.packages, *expansion.dependencies}
            if package not in known and (near := misspelt(package, known)):
                yield MisspeltPackage.at(place, f"unknown package '{package}'", did_you_mean(near))
            elif package in expansion.skipped:
                message = f"the launch files of '{package}' are not here; what they start is not checked"
                yield NotExpanded.at(place, message)
        refused = {
            finding.span
            for finding in expansion.findings
            if finding.rule is UnknownAction and finding.severity is not Severity.WARNING
        }
        yield from (finding for finding in system.findings if finding.span not in refused)
        yield from parameter_findings(system, variants)
        yield from node_findings(system)
        # Programs of this project may run beside the launch files of this project, not beside those of others.
        own = any(node.started.package in self._own for node in system.nodes)
        yield from topic_findings(system, variants, self._known if own else (), complete)
        yield from frame_findings(system, complete, is_varied)


def _loaders(parameter_file: Path) -> Iterator[Path]:
    """Yield the YAML and XML launch files of the package of a parameter file that name it."""
    folder = parameter_file.resolve().parent
    top = next((parent for parent in (folder, *folder.parents) if (parent / "package.xml").is_file()), folder)
    for path in (inner / name for inner, _, names in source_folders(top) for name in names):
        is_plain = path.name.endswith(LAUNCH_ENDINGS) and not is_python(path)
        if is_plain and path.is_file() and parameter_file.name in _text_of(path):
            yield path


def _of_included(finding: Diagnostic, launch_files: Iterable[Path]) -> Diagnostic:
    """Return an undeclared argument as a hint if another launch file names the file, and so may give the argument."""
    own = Path(finding.span.file)
    others = (path for path in launch_files if shown_path(str(path)) != finding.span.file)
    return as_hint(finding) if any(own.name in _text_of(path) for path in others) else finding


def _unknown_arguments(names: Iterable[str], launch_files: Iterable[Path], checked: Checked) -> Iterator[Diagnostic]:
    """Yield a finding for each argument of the command line that no launch file has, as `ros2 launch` ignores it."""
    paths = [*launch_files, *map(Path, checked.evaluated)]
    is_complete = not any(finding.rule is NotExpanded for finding in checked.findings)
    for name in names if paths else ():
        word = re.compile(rf"\b{re.escape(name)}\b")
        if name not in checked.declared and not any(word.search(_text_of(path)) for path in paths):
            place, message = Span(shown_path(str(paths[0]))), f"no launch file has the argument '{name}'"
            finding = UndeclaredArgument.at(place, message, did_you_mean(all_nearest(name, checked.declared, 0.7)))
            yield as_warning(finding) if is_complete else as_hint(finding)


@cache
def _text_of(path: Path) -> str:
    try:
        return bounded_files.read(path).decode(errors="replace")
    except OSError:
        return ""


def _key(finding: Diagnostic) -> tuple[object, ...]:
    return finding.rule.id, finding.span, finding.message


def _known_text(text: str) -> str | None:
    return None if "$(" in text else text


def _once(findings: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """Yield the findings without those that other launch files have at the same place, perhaps with other arguments."""
    seen: set[tuple[object, ...]] = set()
    # The first finding stays: one that says what to write.
    for finding in sorted(findings, key=lambda finding: not finding.help):
        family = finding.rule.id if finding.rule.id not in ("PAR101", "PAR102") else "PAR"
        is_one = (
            family in ("PAR", "PAR103", "TOP101") or finding.rule is TopicFromOutside
        )  # whatever the names of the nodes are
        text = "" if is_one else finding.message.partition(" (with ")[0]
        # A file that is missing for many nodes is missed once.
        place = finding.span.file if finding.rule is MissingFile else finding.span
        key = (family, place, text) if finding.span.line else (family, place, finding.message)
        if key not in seen:
            seen.add(key)
            yield finding


def shown_path(path: str, start: str = os.curdir) -> str:
    """Return the name of a file in messages: relative to the folder ``start``, if it is not far from it."""
    relative = os.path.relpath(path, start)
    return path if relative.startswith(os.path.join(os.pardir, os.pardir, os.pardir)) else Path(relative).as_posix()


def files_to_check(paths: Iterable[Path], missing: Callable[[Path], None]) -> Iterator[Path]:
    """Yield the launch files and parameter files among paths, and in the folders among them.

    In folders, parameter files that launch files use are checked with these only. What colcon builds or ignores is left
    out. ``missing`` gets a path that does not exist, or a folder without such files.
    """
    for path in paths:
        if path.is_file():
            yield path
            continue
        found = [
            folder / name
            for folder, _, names in source_folders(path)
            for name in names
            if (folder / name).is_file() and _is_checked(folder / name)
        ]
        if not found:
            missing(path)
        yield from found


def _is_launch_file(path: Path) -> bool:
    """Return true for a launch file, whatever its name, among files to check."""
    is_named = path.name.endswith(LAUNCH_ENDINGS) or is_python(path)
    return is_named or (not is_parameter_file(path) and is_declarative(path))


def _is_checked(path: Path) -> bool:
    """Return true for a launch file or parameter file in a folder; not for others that have such a name."""
    if path.name.endswith(LAUNCH_ENDINGS):
        return is_launch_program(path) if is_python(path) else is_declarative(path)
    return path.suffix in (".yaml", ".yml") and is_parameter_file(path)
