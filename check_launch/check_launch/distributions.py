"""The distribution that a workspace is for, and findings that only some of the distributions have."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from check_launch.catalogue.catalogue_files import DISTRIBUTIONS
from check_launch.expansion.launch_context import Packages
from check_launch.rules.checking import Checked
from check_launch.rules.launch_rules import OldName, as_hint, as_warning
from roverlink import bounded_files
from roverlink.generator.diagnostics import Diagnostic, Severity, Span

_OLDER = frozenset({"kinetic", "melodic", "noetic", "dashing", "eloquent", "foxy", "galactic"})
"""Distributions before those that have a catalogue; the first three are of ROS 1."""
_OTHERS = (*sorted(_OLDER), "iron", "lyrical", "rolling")
_NAMED = re.compile(rf"\bros[ _-]?2?(?:[_-]distro\w*)?\W{{1,4}}({'|'.join((*DISTRIBUTIONS, *_OTHERS))})\b".encode())
"""`ROS 2 Humble`, `/opt/ros/humble`, `ros:humble`, `ros-humble-nav2-bringup`, `ROS_DISTRO=humble`."""
_BESIDE = ("*", "*/*", ".devcontainer/*", ".github/workflows/*")
_LARGEST = 1 << 18  # bytes of a text that somebody has written
_COMPARED = (Severity.ERROR, Severity.WARNING)
_Key = tuple[str, Span, Severity]


def distributions_of(tops: Iterable[Path], packages: Packages) -> tuple[str, ...]:
    """Return the distributions that a workspace may be for, the likeliest first.

    It is one only if the variable ROS_DISTRO has it, or if the texts of the workspace name no other one. The texts of
    folders with packages, which may be others' repositories, count if the workspace's own name none. ``tops`` are its
    folders, and ``packages`` those in them.
    """
    if named := os.environ.get("ROS_DISTRO"):
        return (named,)
    folders = {one for copies in packages.copies.values() for one in copies}
    around = {parent for one in folders for parent in one.parents}
    beside, above = Counter[str](), Counter[str]()
    for top in {path.resolve() for path in tops}:
        for path in (path for pattern in _BESIDE for path in top.glob(pattern)):
            if path.parent == top or path.parent not in folders | around:
                beside.update(_names_in(path))
            elif path.parent not in folders:
                above.update(_names_in(path))
    counts = beside or above
    if len(counts) == 1 or (counts and counts.keys().isdisjoint(DISTRIBUTIONS)):
        return (counts.most_common(1)[0][0],)
    return tuple(sorted(DISTRIBUTIONS, key=lambda name: -counts[name]))


def _names_in(path: Path) -> set[str]:
    """Return the distributions that a text names, such as README.md or a Dockerfile."""
    with suppress(OSError):
        return {name.decode() for name in _NAMED.findall(bounded_files.read(path, _LARGEST).lower())}
    return set()


def checked_for(distributions: Sequence[str], check: Callable[[str], Checked]) -> Checked:
    """Check for the distribution that refuses the least, and say which of its findings others do not have.

    ``distributions`` are those that a workspace may be for, the likeliest first, and ``check`` checks for one that has
    a catalogue, or without any catalogue for an empty name. What is an error in one distribution only is no certain
    error. What follows from the workspace alone is one in each distribution.
    """
    first, *rest = [name for name in distributions if name in DISTRIBUTIONS] or DISTRIBUTIONS[:1]
    checked = {first: check(first)}
    if not _keys(checked[first]):
        return checked[first]
    checked |= {name: check(name) for name in rest}
    best = min(checked, key=lambda name: len(_keys(checked[name])))
    others = {name: _keys(checked[name]) if name in checked else None for name in (*checked, *distributions)}
    others.pop(best)
    found = checked[best]
    findings = check("").findings if None in others.values() else []
    own = {_key(finding)[:2] for finding in findings if finding.severity in _COMPARED}
    old = {finding.span.file for finding in found.findings if isinstance(finding, OldName)}
    found.findings = [
        finding
        if _key(finding)[:2] in own and not isinstance(finding, OldName)
        else _compared(finding, best, others, finding.span.file in old and finding.rule.id[:3] == "PAR")
        for finding in found.findings
    ]
    return found


def _compared(finding: Diagnostic, first: str, others: Mapping[str, Set[_Key] | None], beside_old: bool) -> Diagnostic:
    parts = [
        f"there is no catalogue of {name}" if keys is None else f"not in {name}"
        for name, keys in others.items()
        if keys is None or _key(finding) not in keys
    ]
    if others and isinstance(finding, OldName):
        parts.append("right in older distributions")
    elif others and beside_old:
        parts.append("the file has a name of an older distribution")
    if finding.severity not in _COMPARED or not parts:
        return finding
    lowered = as_hint if _OLDER & set(others) else as_warning
    return lowered(replace(finding, message=f"{finding.message} (in {first}; {', '.join(parts)})"))


def _key(finding: Diagnostic) -> _Key:
    return finding.rule.id, finding.span, finding.severity


def _keys(checked: Checked) -> set[_Key]:
    return {_key(finding) for finding in checked.findings if finding.severity in _COMPARED}
