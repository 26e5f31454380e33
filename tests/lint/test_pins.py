"""States of the protos that other projects are pinned to: who misreads whom, and that `--against` agrees."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from comparing import changes_found, compiled
from mutations import BASE, MODERN, MUTATIONS, together
from repositories import RepositoryBuilder, git, message

from roverlink.__main__ import main
from roverlink.generator.diagnostics import Severity
from roverlink.generator.lint.comparison import SchemaChange
from roverlink.generator.lint.misreadings import misreadings
from roverlink.generator.protos.files import read_protos
from roverlink.generator.protos.schema import Schema
from roverlink.generator.protos.uncompiled import with_uncompiled

_ARM, _ENVELOPE = "protos/arm.proto", "protos/envelope.proto"
_TREE = ("--envelope", "envelope.proto", "--message", "Envelope")
_FREED = ("WIR102", "WIR106", "WIR107", "ENV107")  # a number that is merely free is misread by nobody
_BYTES = "a receiver of string misreads bytes"
_LINK = 'syntax = "proto3";\nimport "arm.proto";\n\nmessage Envelope {\n  oneof payload {\n    Arm arm = 1;\n  }\n}\n'


def _verdicts(out: str) -> list[list[str]]:
    """Return the rows of the matrices in the text of the lint, each as a name and the words of its cells."""
    cells = r"(?: +(?:same|compatible|doubtful \d+|misread \d+))+"
    found = [match for line in out.splitlines() if (match := re.fullmatch(rf"  \d+ (.+?)({cells}) *", line))]
    return [[match[1].strip(), *re.findall(r"same|compatible|\w+ \d+", match[2])] for match in found]


def _lint(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    main(["lint", *map(str, arguments)])
    said = capsys.readouterr()
    assert said.err == ""
    return said.out


# --- one judgement ---


def _by_the_rules(before: Schema, after: Schema) -> set[tuple[str, int | None, bool]]:
    """Return type and number of each finding of `--against` about bytes that are misread, and if it is an error.

    The entry of a map stands for the map, as for the people who read the file.
    """
    maps = {field.type_name: (one.full_name, field.number) for one in after.messages.values() for field in one.fields}
    entries = {name for name, one in after.messages.items() if one.map_entry}
    in_messages = after.messages.keys() | after.reachable(*after.messages)[1]
    return {
        (*(maps[one.type] if one.type in entries else (one.type, one.number)), one.severity is Severity.ERROR)
        for one in changes_found(before, after)
        if one.rule.id not in _FREED and one.type in in_messages
    }


def _gravest(found: set[tuple[str, int | None, bool]]) -> set[tuple[str, int | None, bool]]:
    return {one for one in found if one[2] or (*one[:2], True) not in found}


@pytest.mark.slow
def test_the_judgement_is_that_of_against(tmp_path: Path) -> None:
    """Of some hundred edits, consumers misread what `--against` calls an error, and text that became bytes."""
    edit = together(MUTATIONS)
    before, after = compiled(edit.before, tmp_path / "before"), compiled(edit.after, tmp_path / "after")
    both = [name for name in before.messages.keys() & after.messages.keys() if not after.messages[name].map_entry]
    found = {one for name in both for one in misreadings(SchemaChange(before, after), name, name)}
    ours = _gravest({(one.owner, one.number, one.certain) for one in found if one.reason != _BYTES})
    assert ours == _gravest(_by_the_rules(before, after))


def test_a_state_is_the_same_as_itself(tmp_path: Path) -> None:
    """No message of a schema is misread by itself, and none by what the tolerant parser makes of its files."""
    files = {path: text for path, text in BASE.items() if path != MODERN}  # it has presence as an option
    schema, parsed = compiled(files, tmp_path), read_protos(tmp_path, "", [])
    lenient = with_uncompiled(Schema(uncompiled=tuple(parsed)), parsed, "")
    for name in schema.messages:
        assert misreadings(SchemaChange(schema, schema), name, name) == ()
        assert misreadings(SchemaChange(schema, lenient), name, name) == ()
        assert misreadings(SchemaChange(lenient, schema), name, name) == ()
    assert lenient.messages.keys() <= schema.messages.keys()


# --- the matrix ---


class Arms:
    """A repository whose envelope holds the payload Arm, and a file of pins."""

    def __init__(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self._repository, self._capsys, self.pins = (
            RepositoryBuilder(folder / "protos.git"),
            capsys,
            folder / "pins.txt",
        )
        self._repository.commit("Begin", {_ENVELOPE: _LINK})
        self.commit("Begin", "float voltage", "float current")

    def commit(self, subject: str, *fields: str) -> None:
        """Commit other fields of the payload."""
        self._repository.commit(subject, {_ARM: message("Arm", *fields)})

    def lint(self, *pins: str, json_of: bool = False) -> str:
        """What the lint prints of these pins."""
        self.pins.write_text("".join(f"{pin}\n" for pin in pins))
        format = ("--format", "json") if json_of else ()
        return _lint(self._capsys, self._repository.write() / "protos", *_TREE, "--pins", self.pins, *format)

    def found(self, *pins: str) -> list[dict[str, Any]]:
        """The findings about these pins."""
        found: list[dict[str, Any]] = json.loads(self.lint(*pins, json_of=True))
        return found

    def id(self, ref: str) -> str:
        """The short id of a commit."""
        return git(self._repository.root, "rev-parse", "--short=10", ref).strip()


@pytest.fixture
def arms(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Arms:
    """The repository."""
    return Arms(tmp_path, capsys)


@pytest.mark.slow
def test_many_projects_with_two_states_give_one_finding(arms: Arms) -> None:
    """Ten projects of two states differ in one field: one finding names all of them, and the matrix has two rows."""
    arms.commit("Change", "float humidity", "float current")
    pins = [f"board{index} main~{index % 2}" for index in range(10)]
    (found,) = arms.found(*pins)
    assert found["message"] == (
        "number 1 of 'Arm' is `float voltage = 1;` in 'board1', 'board3', 'board5', 'board7' and 'board9', "
        "but `float humidity = 1;` in this checkout, 'board0', 'board2', 'board4', 'board6' and 'board8': "
        "'voltage' and 'humidity' are different words"
    )
    assert [row[1:] for row in _verdicts(arms.lint(*pins))] == [["same", "misread 1"], ["misread 1", "same"]]


@pytest.mark.slow
def test_a_finding_names_declarations_commits_and_what_to_do(arms: Arms) -> None:
    """Two projects and the checkout: each declaration with its commit, each commit with its projects."""
    arms.commit("Measure humidity", "float humidity", "float current")
    (found,) = arms.found("rover main", "arm main~1")
    old, new = arms.id("main~1"), arms.id("main")
    assert (found["id"], found["severity"], found["path"], found["line"]) == ("PIN102", "error", "arm.proto", 4)
    assert [(one["path"], one["line"], one["text"]) for one in found["also"]] == [
        (f"{old}:protos/arm.proto", 4, f"`float voltage = 1;` at {old} 2026-02-04 Begin"),
        (str(arms.pins), 2, f"'arm' is pinned to {old} 2026-02-04 Begin"),
        (str(arms.pins), 1, f"'rover' is pinned to {new} 2026-02-05 Measure humidity"),
    ]
    assert found["help"] == (
        "build the other projects from this checkout before they exchange messages with it, "
        "or put back `float voltage = 1;` and give the new declaration a number of its own"
    )


@pytest.mark.slow
@pytest.mark.parametrize("width", [40, 120])
def test_the_matrix_fits_the_terminal(arms: Arms, monkeypatch: pytest.MonkeyPatch, width: int) -> None:
    """Eight projects with eight states and long names: no line is longer than the terminal, and no cell is cut."""
    monkeypatch.setenv("COLUMNS", str(width))
    for index in range(1, 8):
        arms.commit(str(index), "float voltage", "float current", *(f"float added_{number}" for number in range(index)))
    out = arms.lint(*(f"the-project-on-board-number-[{index}] main~{index}" for index in range(8)))
    assert max(map(len, out.splitlines())) <= width
    assert (out.count("same"), out.count("compatible")) == (8, 8 * 7)
