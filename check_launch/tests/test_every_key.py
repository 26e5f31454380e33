"""Every change of one character in every key of the shipped parameter files: half a million misspelt parameters.

The launch files are expanded once, and each changed key is looked up among the parameters of the nodes that get it.
Where the new name is known or the key is the name of a plugin, the rules about parameters judge. `test_shipped_files`
checks one change of each key with the whole command.
"""

from __future__ import annotations

import random
import string
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
import yaml
from check_launch.catalogue.catalogue_files import read_catalogue
from check_launch.catalogue.facts import Catalogue
from check_launch.expansion.launch_context import Packages
from check_launch.own_programs import with_own_programs
from check_launch.rules.checking import Checker
from check_launch.rules.known_parameters import ParameterView
from check_launch.rules.parameter_findings import parameter_findings, used_parameters
from check_launch.rules.system import RunningNode, System, Variants
from shipped_files import LAUNCH_FILES

_ROOT = Path(__file__).parents[2]
_ARGUMENTS: tuple[dict[str, str], ...] = ({}, {"stvl": "true"}, {"localization": "slam"})
"""Arguments with which each shipped parameter is used."""
_LETTERS = string.ascii_letters + string.digits + "_./"
_OF_ANOTHER_SENSOR = {
    "odom1_twist_rejection_threshold -> odom0_twist_rejection_threshold",
    "odom1_twist_rejection_threshold -> odom2_twist_rejection_threshold",
    "odom2_pose_rejection_threshold -> odom0_pose_rejection_threshold",
    "odom2_pose_rejection_threshold -> odom1_pose_rejection_threshold",
}
"""Changes that make a right parameter: the threshold of another sensor, which has none. No rule can find them."""


def _changed(text: str, sample: int | None) -> set[str]:
    """Return a key with each letter left out, replaced, inserted, and swapped; ``sample`` limits the number."""
    found = set()
    for at in range(len(text) + 1):
        before, here, after = text[:at], text[at : at + 1], text[at + 1 :]
        found |= {before + after, before + after[:1] + here + after[1:]}
        found |= {before + letter + rest for letter in _LETTERS for rest in (here + after, after)}
    found -= {text}
    chosen = random.Random(text)  # noqa: S311  # no secret: the same changes in each run
    return found if sample is None else set(chosen.sample(sorted(found), sample))


@dataclass(frozen=True)
class _Key:
    """A key of a parameter file: of a parameter, or of a plugin with parameters."""

    text: str
    prefix: str
    parameters: dict[tuple[int, int], str]
    """Names of the parameters that it has a part in, by line and column."""
    is_parameter: bool


def _keys(node: yaml.Node | None, prefix: str, in_parameters: bool) -> Iterator[_Key]:
    for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
        if key.value == "ros__parameters" or not in_parameters:
            yield from _keys(value, "", in_parameters or key.value == "ros__parameters")
            continue
        inner = list(_keys(value, f"{prefix}{key.value}.", True))
        place = (key.start_mark.line + 1, key.start_mark.column + 1)
        names = {at: name for one in inner for at, name in one.parameters.items()}
        yield _Key(key.value, prefix, names or {place: prefix + key.value}, not inner)
        yield from inner


def _nodes(launch_file: str, catalogue: Catalogue) -> list[RunningNode]:
    """Return the nodes that a launch file starts with different arguments; none twice with the same parameters."""
    found: dict[tuple[str, str], RunningNode] = {}
    for arguments in _ARGUMENTS:
        checker = Checker(catalogue, Packages([_ROOT / "rover" / "navigation", _ROOT / "generated" / "ros"]))
        ((_, system),) = checker.check([_ROOT / launch_file], arguments).systems
        for node in system.nodes:
            if node.view is not None:
                given = [(one.name, one.value) for one in node.view.given.values()]
                found.setdefault((node.full_name, str(given)), node)
    return list(found.values())


def _is_reported(node: RunningNode, names: dict[str, str], catalogue: Catalogue) -> bool:
    """Return true if the rules about parameters report a node some of whose parameters have other names."""
    assert node.view is not None
    assert node.facts is not None
    renamed = [replace(one, name=names.get(name, name)) for name, one in node.view.given.items()]
    given = {one.name: one for one in renamed}
    if len(given) < len(renamed):
        return True  # a parameter stands twice
    view = ParameterView(node.facts, given, catalogue)
    started = replace(node.started, files=(), remappings=())
    system = System([RunningNode(started, node.facts, node.name, node.namespace, node.is_inner, view=view)])
    variants = Variants(frozenset(used_parameters(system)), frozenset(), frozenset())
    return any(one.severity.value != "hint" for one in parameter_findings(system, variants))


def _missed(key: _Key, news: set[str], file: str, nodes: list[RunningNode], catalogue: Catalogue) -> Iterator[str]:
    """Yield the changes of a key that give no finding in any node that gets it."""
    users = []
    for node in nodes:
        assert node.view is not None
        got = [
            one.name
            for one in node.view.given.values()
            if one.place.file.endswith(file) and (one.place.line, one.place.column) in key.parameters
        ]
        others = {name: one for name, one in node.view.given.items() if name not in got}
        if got:
            assert node.facts is not None
            users.append((node, got, ParameterView(node.facts, others, catalogue)))
    assert users, f"nothing uses {key.text}"
    end = len(key.prefix) + len(key.text)
    for new in news:
        undecided = []
        for node, got, view in users:
            names = {name: key.prefix + new + name[end:] for name in got}
            if not key.is_parameter or any(
                view.known(one) or view.is_open(one) or one.endswith(".plugin") for one in names.values()
            ):
                undecided.append((node, names))
        if undecided and not any(_is_reported(node, names, catalogue) for node, names in undecided):
            yield f"{key.text} -> {new}"


def _missed_in(files: Iterable[str], sample: int | None = None) -> tuple[set[str], int]:
    """Return the missed changes of all keys of parameter files, and the number of the changes."""
    catalogue = with_own_programs(read_catalogue("humble"), _ROOT / "mapping.yaml")
    missed, count = set(), 0
    for file in files:
        nodes = _nodes(LAUNCH_FILES[file], catalogue)
        for key in _keys(yaml.compose((_ROOT / file).read_text(encoding="utf-8")), "", False):
            news = _changed(key.text, sample)
            missed |= set(_missed(key, news, file, nodes, catalogue))
            count += len(news)
    return missed, count


@pytest.mark.slow
def test_changes_of_keys_are_found() -> None:
    """A sample of the changes of one character in the parameters of the IMU's filter gives a finding each."""
    assert _missed_in(["rover/navigation/config/imu_filter.yaml"], sample=20)[0] == set()


@pytest.mark.exhaustive
def test_every_change_of_a_key_is_found() -> None:
    """Each change of one character in each shipped key gives a finding, unless it makes another sensor's parameter."""
    missed, count = _missed_in(LAUNCH_FILES)
    assert missed == _OF_ANOTHER_SENSOR
    assert count > 500_000
