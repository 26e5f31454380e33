"""The whole path of a team with protos of its own: adopt them in a project, and lint changes of them.

The tree has the shapes of a real one: a file that the envelope does not import and that clashes with it, and numbers
that were removed without being reserved. The project has it as a submodule.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from repositories import ENVELOPE_FILE, PAYLOADS, RepositoryBuilder, envelope, git, members, message

_CLASHING = "components/common/message_types.proto"
_IMPORTS = "\n".join(f'import "{file}";' for file in PAYLOADS)
_GONE = [f"{name} {name.lower()} = {number};" for number, name in enumerate(("Flick", "Turn", "Grip", "Halt"), 27)]
_OF_GONE = {f"{name}.proto": message(name, "float x") for name in ("Flick", "Turn", "Grip", "Halt")}
_IN_CI = ("--against", "main", "--history")  # the command that `init` prints


def _envelope(*lines: str, more: str = "") -> str:
    return envelope(*members("I1 G2 P3 L4"), *lines).replace("\n\n", f"\n\n{_IMPORTS}\n{more}\n", 1)


_TREE = {
    **PAYLOADS,
    ENVELOPE_FILE: _envelope(),
    _CLASHING: 'syntax = "proto3";\n\nenum MessageType {\n  None = 0;\n  Imu = 1;\n}\n',
    **dict.fromkeys(_OF_GONE),
}
_OF_WIND = {
    "wind.proto": message("Wind", "float gust", "float angle"),
    ENVELOPE_FILE: _envelope("Wind wind = 27;", more='import "wind.proto";'),
}
# What a change does, and the ids of its errors: in a lint of the tree, and in one of the project, which has a row less.
_CHANGES: Mapping[str, tuple[Mapping[str, str | None], list[str], list[str]]] = {
    "harmless": ({"imu.proto": f"{PAYLOADS['imu.proto']}// only a comment\n"}, [], []),
    "reusing": (_OF_WIND, ["HIS101"], ["ENV105"]),
    "repairing": ({_CLASHING: None}, [], []),
}


def _errors(said: tuple[int, list[dict[str, Any]]]) -> tuple[int, list[str]]:
    return said[0], [finding["id"] for finding in said[1] if finding["severity"] != "hint"]


@pytest.mark.slow
def test_from_a_strangers_tree_to_a_change_of_it(
    repository: RepositoryBuilder,
    run: Callable[..., tuple[int, str, str]],
    found: Callable[..., tuple[int, list[dict[str, Any]]]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Nothing fails right after `init --from`; then only what a change breaks does, with and without a table."""
    imports = "\n".join(f'import "{file}";' for file in _OF_GONE)
    repository.commit("Begin", {**PAYLOADS, **_OF_GONE, ENVELOPE_FILE: _envelope(*_GONE, more=imports)})
    begun = repository.commit("Remove the manual control", _TREE)
    for name, (files, _, _) in _CHANGES.items():
        repository.branch(name, begun)
        repository.commit(name, files, branch=name)
    team, rover = repository.write(), tmp_path / "rover"
    rover.mkdir()
    git(rover, "init", "--quiet", "--initial-branch", "main")
    git(
        rover, "-c", "protocol.file.allow=always", "submodule", "--quiet", "add", "--branch", "main", str(team), "proto"
    )
    monkeypatch.chdir(rover)
    assert run("init", "--from", "proto")[0] == 0
    assert run("generate", "--check")[0] == 0
    assert _errors(found()) == (0, [])
    for name, (_, of_tree, of_project) in _CHANGES.items():
        git(team, "checkout", "--quiet", name)
        assert (name, *_errors(found(team, "--message", "PBEnvelope", *_IN_CI))) == (name, int(bool(of_tree)), of_tree)
        git(rover / "proto", "checkout", "--quiet", f"origin/{name}")
        assert (name, *_errors(found())) == (name, int(bool(of_project)), of_project)
