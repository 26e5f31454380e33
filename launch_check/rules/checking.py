"""Check of launch files and parameter files with all rules."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity, in_order
from roverlink.launch_check.catalogue.facts import Catalogue
from roverlink.launch_check.expansion.actions import Problem
from roverlink.launch_check.expansion.context import Packages
from roverlink.launch_check.expansion.entities import UnreadableFile
from roverlink.launch_check.expansion.expander import Expander, Expansion, variations
from roverlink.launch_check.expansion.parameter_files import is_parameter_file, read_parameter_file
from roverlink.launch_check.rules.frame_findings import frame_findings
from roverlink.launch_check.rules.launch_rules import (
    NOT_EXPANDED,
    UNDECLARED_ARGUMENT,
    UNKNOWN_ACTION,
    UNREADABLE,
    WRONG_VALUE,
)
from roverlink.launch_check.rules.parameter_findings import parameter_findings, standalone_findings
from roverlink.launch_check.rules.system import System, span, system_of
from roverlink.launch_check.rules.topic_findings import topic_findings

LAUNCH_ENDINGS = ("launch.py", "launch.xml", "launch.yaml", "launch.yml", ".launch")
_RULES: Mapping[str, Rule] = {
    "element": UNKNOWN_ACTION,
    "text": UNKNOWN_ACTION,
    "condition": WRONG_VALUE,
    "choice": WRONG_VALUE,
    "argument": UNDECLARED_ARGUMENT,
    "include": UNREADABLE,
    "parameter-file": UNREADABLE,
    "needs": NOT_EXPANDED,
}


@dataclass(slots=True)
class Checked:
    """Result of a check."""

    findings: list[Diagnostic] = field(default_factory=list)
    systems: list[tuple[str, System]] = field(default_factory=list)
    """What each launch file starts with the defaults of its arguments, by the name of the file."""


class Checker:
    """Checks files with the facts of a catalogue."""

    def __init__(self, catalogue: Catalogue, packages: Iterable[Path], complete: bool = False) -> None:
        """``packages`` are folders with packages; ``complete`` says that the launch files start everything."""
        self._catalogue, self._complete = catalogue, complete
        stored = {
            (name, path): actions for name, one in catalogue.packages.items() for path, actions in one.launch_files.items()
        }
        self._expander = Expander(Packages(packages), shown_path, stored, catalogue.packages)

    def check(self, files: Iterable[Path], arguments: Mapping[str, str]) -> Checked:
        """Check launch files with some values of their arguments, and parameter files."""
        checked = Checked()
        for path in files:
            try:
                if path.name.endswith(LAUNCH_ENDINGS):
                    self._check_launch_file(path, arguments, checked)
                else:
                    sections = read_parameter_file(path, shown_path(str(path)), lambda text: None if "$(" in text else text)
                    checked.findings += standalone_findings(sections, self._catalogue)
            except UnreadableFile as error:
                checked.findings.append(UNREADABLE.at(span(error.place), str(error)))
        checked.findings = in_order(checked.findings)
        return checked

    def _check_launch_file(self, path: Path, arguments: Mapping[str, str], checked: Checked) -> None:
        expansion = self._expander.expand(path, arguments)
        system = system_of(expansion, self._catalogue)
        checked.systems.append((shown_path(str(path)), system))
        findings = list(self._of_expansion(expansion, system))
        checked.findings += findings
        known = {_key(one) for one in findings}
        for values in variations(expansion):
            other = self._expander.expand(path, {**arguments, **values})
            chosen = " ".join(f"{name}:={value}" for name, value in values.items())
            for one in self._of_expansion(other, system_of(other, self._catalogue)):
                if _key(one) not in known and one.severity is not Severity.HINT:
                    known.add(_key(one))
                    checked.findings.append(replace(one, message=f"{one.message} (with {chosen})"))

    def _of_expansion(self, expansion: Expansion, system: System) -> Iterator[Diagnostic]:
        yield from (_of_problem(one) for one in expansion.problems)
        for name, place in expansion.undeclared:
            yield UNDECLARED_ARGUMENT.at(span(place), f"the argument '{name}' is not declared", "declare it with `arg`")
        for package, place in expansion.skipped.items():
            message = f"the launch files of '{package}' are not here; what they start is not checked"
            yield NOT_EXPANDED.at(span(place), message)
        yield from system.findings
        yield from parameter_findings(system, self._catalogue)
        yield from topic_findings(system, self._complete)
        yield from frame_findings(system, self._complete)


def _key(finding: Diagnostic) -> tuple[object, ...]:
    return finding.rule.id, finding.span, finding.message


def _of_problem(problem: Problem) -> Diagnostic:
    return _RULES[problem.kind].at(span(problem.place), problem.message, problem.help)


def shown_path(path: str) -> str:
    """Return the name of a file in messages: relative to the current folder, if it is not far from it."""
    relative = os.path.relpath(path)
    return path if relative.startswith(os.path.join(os.pardir, os.pardir, os.pardir)) else Path(relative).as_posix()


def files_to_check(paths: Iterable[Path], missing: Callable[[Path], None]) -> Iterator[Path]:
    """Yield the launch files and parameter files among paths, and in the folders among them.

    In folders, parameter files that launch files use are checked with these only. ``missing`` gets a path that does
    not exist, or a folder without such files.
    """
    for path in paths:
        if path.is_file():
            yield path
            continue
        found = [
            one
            for one in (sorted(path.rglob("*")) if path.is_dir() else ())
            if one.is_file()
            and not any(part.startswith(".") for part in one.relative_to(path).parts)
            and (one.name.endswith(LAUNCH_ENDINGS) or (one.suffix in (".yaml", ".yml") and is_parameter_file(one)))
        ]
        if not found:
            missing(path)
        yield from found
