"""Check of launch files and parameter files with all rules."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from check_launch.catalogue.facts import OWN_SOURCE, Catalogue
from check_launch.expansion.child_process import DEFAULT_LIMITS, Limits
from check_launch.expansion.entities import UnreadableFileError, text_of_file
from check_launch.expansion.expander import Expander, Expansion
from check_launch.expansion.launch_context import Packages
from check_launch.expansion.parameter_files import ParameterFile, is_parameter_file
from check_launch.expansion.python_files import is_launch_program
from check_launch.expansion.source_trees import source_folders
from check_launch.rules.frame_findings import frame_findings
from check_launch.rules.launch_rules import (
    NotExpanded,
    TopicFromOutside,
    UndeclaredArgument,
    UnreadableLaunchFile,
)
from check_launch.rules.parameter_findings import (
    parameter_findings,
    standalone_findings,
    used_parameters,
    used_sections,
)
from check_launch.rules.system import System, Variants, system_of
from check_launch.rules.topic_findings import ends_of, topic_findings, used_remappings
from roverlink.generator.diagnostics import Diagnostic, Severity, in_order

LAUNCH_ENDINGS = ("launch.py", "launch.xml", "launch.yaml", "launch.yml", ".launch")
_COMPLETE = re.compile(r"^[ \t]*(?:#|<!--)[ \t]*check-launch: complete\b", re.MULTILINE)
"""Comment in a launch file that starts everything."""


@dataclass(slots=True)
class Checked:
    """Result of a check."""

    findings: list[Diagnostic] = field(default_factory=list)
    systems: list[tuple[str, System]] = field(default_factory=list)
    """System that each launch file starts with the defaults of its arguments, by the name of the file."""


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
        checked, paths = Checked(), list(files)
        used: set[str] = set()
        for path in sorted(paths, key=lambda path: not path.name.endswith(LAUNCH_ENDINGS)):
            try:
                if path.name.endswith(LAUNCH_ENDINGS):
                    used |= self._check_launch_file(path, arguments, checked)
                elif shown_path(str(path)) not in used:
                    sections = ParameterFile(path, shown_path(str(path))).sections(_known_text)
                    checked.findings += standalone_findings(sections, self._catalogue)
            except UnreadableFileError as error:
                checked.findings.append(UnreadableLaunchFile.at(error.place, str(error)))
        checked.findings = in_order(_once(checked.findings))
        return checked

    def _check_launch_file(self, path: Path, arguments: Mapping[str, str], checked: Checked) -> set[str]:
        """Check a launch file; return the parameter files that it uses."""
        expansions = self._expander.variants(path, arguments)
        systems = [system_of(expanded, self._catalogue) for expanded in expansions]
        checked.systems.append((shown_path(str(path)), systems[0]))
        variants = Variants(
            frozenset().union(*map(used_parameters, systems)),
            frozenset().union(*map(used_sections, systems)),
            frozenset().union(*map(used_remappings, systems)),
            frozenset().union(*map(ends_of, systems)),
        )
        complete = self._complete or _COMPLETE.search(text_of_file(path, shown_path(str(path)))) is not None
        known: set[tuple[object, ...]] = set()
        for expanded, system in zip(expansions, systems, strict=True):
            varied = ((name, value) for name, value in expanded.arguments.items() if name not in arguments)
            chosen = " ".join(f"{name}:={'...' if value is None else value}" for name, value in varied)
            for finding in self._of_expansion(expanded, system, variants, complete):
                if _key(finding) in known or (chosen and finding.severity is Severity.HINT):
                    continue
                known.add(_key(finding))
                checked.findings.append(
                    replace(finding, message=f"{finding.message} (with {chosen})") if chosen else finding
                )
        return {use.shown for system in systems for node in system.nodes for use in node.started.files}

    def _of_expansion(
        self, expansion: Expansion, system: System, variants: Variants, complete: bool
    ) -> Iterator[Diagnostic]:
        yield from expansion.findings
        for name, place in expansion.undeclared:
            yield UndeclaredArgument.at(place, f"the argument '{name}' is not declared", "declare it with `arg`")
        for package, place in expansion.skipped.items():
            message = f"the launch files of '{package}' are not here; what they start is not checked"
            yield NotExpanded.at(place, message)
        yield from system.findings
        yield from parameter_findings(system, self._catalogue, variants)
        yield from topic_findings(system, variants, self._known, complete)
        yield from frame_findings(system, complete)


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
        is_one = family in ("PAR", "TOP101") or finding.rule is TopicFromOutside  # whatever the names of the nodes are
        text = "" if is_one else finding.message.partition(" (with ")[0]
        key = (family, finding.span, text) if finding.span.line else (family, finding.span, finding.message)
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


def _is_checked(path: Path) -> bool:
    """Return true for a launch file or parameter file in a folder; not for Python files without launch description."""
    if path.name.endswith(LAUNCH_ENDINGS):
        return path.suffix != ".py" or is_launch_program(path)
    return path.suffix in (".yaml", ".yml") and is_parameter_file(path)
