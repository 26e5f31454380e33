"""Every golden case gives what it is expected to give; see `golden` for what a case is and how to write one."""

from __future__ import annotations

from pathlib import Path

import pytest
from case_file import CaseFile
from golden import CASES, DIGESTS, digests, exit_code, generate, in_brief, passing_cases, snapshot

_DIGESTS = dict(line.split(": ", 1) for line in DIGESTS.read_text(encoding="utf-8").splitlines())


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_case(case: CaseFile, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """The project compiles to the expected files, or the expected findings are all that comes of it.

    Every module that was generated, protoc's included, is Python.
    """
    project = case.write_inputs(tmp_path / "project")
    before = snapshot(project)
    run = generate(project)
    after = snapshot(project)
    made = {path: content for path, content in after.items() if before.get(path) != content}
    assert run.code == exit_code(run.stderr)
    assert run.code == 0 or after == before
    for path, content in made.items():
        if path.endswith((".py", ".pyi")):
            compile(content, path, "exec")
    found = _found(case, run.stderr, after)
    if request.config.getoption("update_cases"):
        case.update(found)
        _DIGESTS.update({case.name: digests(made)} if made else {})
        lines = [f"{one.name}: {_DIGESTS[one.name]}\n" for one in passing_cases() if one.name in _DIGESTS]
        DIGESTS.write_text("".join(lines), encoding="utf-8")
    else:
        assert found == case.expectations
        expected = _DIGESTS.get(case.name, "").split()
        assert digests(made).split() == expected, "golden.py tells how to see what changed"


def _found(case: CaseFile, printed: str, files: dict[str, bytes]) -> dict[str, str]:
    """What a run shows of each thing that a case expects."""
    brief = "found" in case.expectations
    found = {"found": in_brief(printed)} if brief else {"stderr": printed} if printed else {}
    for name, text in case.expectations.items():
        if name.startswith("lines/"):
            rest = iter(files[name.removeprefix("lines/")].decode().splitlines(keepends=True))
            found[name] = "".join(line for line in text.splitlines(keepends=True) if line in rest)
    return found
