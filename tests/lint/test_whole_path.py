"""The whole path of a team with protos of its own: adopt them in a project, and lint changes of them.

The tree has the shapes of a real one: a file that the envelope does not import and that clashes with it, two packages
with one name, and numbers that were removed without being reserved. The project has it as a submodule.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from repositories import ENVELOPE_FILE, PAYLOADS, RepositoryBuilder, envelope, git, members, message

_IN_CI = ("--against", "main", "--history")  # the command that `init` prints
_CLASH = {"components/common/message_types.proto": 'syntax = "proto3";\nenum Kind { None = 0; Imu = 1; }\n'}
_GONE = ("Flick", "Turn", "Grip", "Halt")
_OF_GONE = {f"{name}.proto": message(name, "float x") for name in _GONE}
_STATUS = {f"{part}.proto": f'syntax = "proto3";\npackage {part};\nmessage Status {{}}\n' for part in ("arm", "drive")}


def _envelope(*imported: str, lines: list[str]) -> dict[str, str]:
    imports = "".join(f'import "{file}";\n' for file in (*PAYLOADS, *imported))
    return {ENVELOPE_FILE: envelope(*members("I1 G2 P3 L4"), *lines).replace("\n\n", f"\n\n{imports}", 1)}


_BEGUN = _envelope(*_OF_GONE, lines=[f"{name} {name.lower()} = {number};" for number, name in enumerate(_GONE, 27)])
_WIND = {"wind.proto": message("Wind", "float gust"), **_envelope("wind.proto", lines=["Wind wind = 27;"])}
# The ids of the errors of each change: in a lint of the tree, and in one of the project, which lacks the new row.
_CHANGES: dict[str, tuple[dict[str, Any], list[str], list[str]]] = {
    "harmless": ({"imu.proto": f"{PAYLOADS['imu.proto']}// only a comment\n"}, [], []),
    "reusing": (_WIND, ["HIS101"], ["ENV105"]),
    "repairing": (dict.fromkeys(_CLASH), [], []),
}


@pytest.mark.slow
def test_from_a_strangers_tree_to_a_change_of_it(
    repository: RepositoryBuilder,
    run: Callable[..., tuple[int, str, str]],
    found: Callable[..., tuple[int, list[dict[str, Any]]]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Nothing fails right after `init --from`; then only what a change breaks does, with and without a table."""

    def errors(*arguments: str | Path) -> tuple[int, list[str]]:
        code, all = found(*arguments)
        return code, [finding["id"] for finding in all if finding["severity"] != "hint"]

    repository.commit("Begin", {**PAYLOADS, **_OF_GONE, **_CLASH, **_STATUS, **_BEGUN})
    begun = repository.commit("Remove the manual control", {**dict.fromkeys(_OF_GONE), **_envelope(lines=[])})
    for name, (files, _, _) in _CHANGES.items():
        repository.branch(name, begun)
        repository.commit(name, files, branch=name)
    team, rover = repository.write(), tmp_path / "rover"
    rover.mkdir()
    git(rover, "init", "--quiet", "--initial-branch", "main")
    git(rover, "-c", "protocol.file.allow=always", "submodule", "--quiet", "add", str(team), "proto")
    monkeypatch.chdir(rover)
    assert run("init", "--from", "proto")[0] == 0
    assert git(rover / "proto", "status", "--porcelain") == ""
    assert run("generate", "--check")[0] == 0
    assert errors() == (0, [])
    for name, (_, of_tree, of_project) in _CHANGES.items():
        git(team, "checkout", "--quiet", name)
        assert (name, *errors(team, "--message", "PBEnvelope", *_IN_CI)) == (name, len(of_tree), of_tree)
        git(rover / "proto", "checkout", "--quiet", f"origin/{name}")
        assert (name, *errors()) == (name, len(of_project), of_project)
