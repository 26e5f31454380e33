"""States of the protos that other projects are pinned to: who misreads whom, and that `--against` agrees."""

from __future__ import annotations

import json
import re
import tempfile
from itertools import combinations
from pathlib import Path
from random import Random

import pytest
from comparing import changes_found, compiled
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from mutations import BASE, MODERN, MUTATIONS, Mutation, together
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
_OF_THE_WHOLE = ("WIR113",)  # it sums up the findings about the fields of a message
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


# --- one judgement ------------------------------------------------------------------------------------------------


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


@pytest.mark.parametrize(
    "edits",
    [
        pytest.param(MUTATIONS[::12], id="some"),
        pytest.param(MUTATIONS, id="all", marks=pytest.mark.slow),
    ],
)
def test_the_judgement_is_that_of_against(edits: list[Mutation], tmp_path: Path) -> None:
    """Of some hundred edits, consumers misread what `--against` calls an error, and text that became bytes."""
    edit = together(edits)
    before, after = compiled(edit.before, tmp_path / "before"), compiled(edit.after, tmp_path / "after")
    both = [name for name in before.messages.keys() & after.messages.keys() if not after.messages[name].map_entry]
    found = {one for name in both for one in misreadings(SchemaChange(before, after), name, name)}
    ours = _gravest({(one.owner, one.number, one.certain) for one in found if one.reason != _BYTES})
    assert ours == _gravest(_by_the_rules(before, after))


def test_text_that_became_bytes_is_misread_by_the_older_program(tmp_path: Path) -> None:
    """`--against` asks if new programs read old bytes; consumers send in both directions."""
    (edit,) = (one for one in MUTATIONS if one.name == "string_to_bytes")
    before, after = compiled(edit.before, tmp_path / "before"), compiled(edit.after, tmp_path / "after")
    for states in ((before, after), (after, before)):
        (found,) = misreadings(SchemaChange(*states), "rover.Telemetry", "rover.Telemetry")
        assert found.certain
    assert _by_the_rules(before, after) == set()


def test_a_state_is_the_same_as_itself(tmp_path: Path) -> None:
    """No message of a schema is misread by itself, and none by what the tolerant parser makes of its files."""
    files = {path: text for path, text in BASE.items() if path != MODERN}  # it has presence as an option
    schema, parsed = compiled(files, tmp_path), read_protos(tmp_path, "", [])
    lenient = with_uncompiled(Schema((), {}, {}, uncompiled=tuple(parsed)), parsed, "")
    for name in schema.messages:
        assert misreadings(SchemaChange(schema, schema), name, name) == ()
        assert misreadings(SchemaChange(schema, lenient), name, name) == ()
        assert misreadings(SchemaChange(lenient, schema), name, name) == ()
    assert lenient.messages.keys() <= schema.messages.keys()


# --- the matrix ---------------------------------------------------------------------------------------------------


def _written(repository: RepositoryBuilder) -> Path:
    root = repository.write()
    git(root, "checkout", "--quiet", "--force", "main")
    return root


def _arm(random: Random) -> str:
    """Draw a payload of up to three fields, with an enum."""
    names = random.sample(["voltage", "battery_voltage", "current", "speed", "velocity"], k=random.randint(1, 3))
    numbers = random.sample([1, 2, 3], k=len(names))
    types = random.choices(["float", "float", "int32", "uint32", "string", "bytes", "Mode"], k=len(names))
    fields = [f"{type} {name} = {number};" for type, name, number in zip(types, names, numbers, strict=True)]
    value = random.choice(["DRIVE", "DOCK", "DRIVING"])
    return f"{message('Arm', *fields, 'Mode mode = 9;')}\nenum Mode {{\n  IDLE = 0;\n  {value} = 1;\n}}\n"


def _errors(out: str) -> set[tuple[str, int]]:
    """Return type and number of the errors about bytes that are misread."""
    found = json.loads(out)
    return {
        (one["message_type"], one["number"])
        for one in found
        if one["severity"] == "error" and not one["id"].startswith((*_FREED, *_OF_THE_WHOLE))
    }


def _of_bytes(out: str) -> set[tuple[str, int]]:
    found = [one for one in json.loads(out) if one["message"].endswith(_BYTES)]
    return {(one["message_type"], one["number"]) for one in found}


@pytest.mark.slow
@settings(suppress_health_check=list(HealthCheck), derandomize=True, max_examples=15, phases=[Phase.generate])
@given(seed=st.integers(0, 2**32))
def test_each_pair_is_judged_as_against_judges_its_commits(
    seed: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The matrix is symmetric, a state is the same as itself, and a pair is misread iff `--against` has errors."""
    monkeypatch.setenv("COLUMNS", "200")  # no name is folded
    random = Random(seed)  # noqa: S311  # a draw, no secret
    with tempfile.TemporaryDirectory() as folder:
        repository = RepositoryBuilder(Path(folder, "protos.git"))
        for index in range(4):
            repository.commit(str(index), {_ARM: _arm(random), _ENVELOPE: _LINK})
        root = _written(repository)
        protos, pins = root / "protos", Path(folder, "pins.txt")
        pins.write_text("".join(f"project{index} main~{3 - index}\n" for index in range(4)))
        rows = _verdicts(_lint(capsys, protos, *_TREE, "--pins", pins))
        cells = [row[1:] for row in rows]
        assert [list(column) for column in zip(*cells, strict=True)] == cells
        assert [row[index] for index, row in enumerate(cells)] == ["same"] * len(cells)
        place = {f"project{n}": index for index, row in enumerate(rows) for n in range(4) if f"project{n}" in row[0]}
        for old, new in combinations(range(4), 2):
            git(root, "checkout", "--quiet", "--detach", f"main~{3 - new}")
            pins.write_text(f"old main~{3 - old}\nnew main~{3 - new}\n")
            found = _lint(capsys, protos, *_TREE, "--pins", pins, "--format", "json")
            against = _lint(capsys, protos, *_TREE, "--against", f"main~{3 - old}", "--format", "json")
            assert _errors(found) - _of_bytes(found) == _errors(against)
            cell = cells[place[f"project{old}"]][place[f"project{new}"]]
            assert cell.startswith("misread") == bool(_errors(found))


@pytest.fixture
def arms(tmp_path: Path) -> RepositoryBuilder:
    """A repository whose envelope holds the payload Arm."""
    built = RepositoryBuilder(tmp_path / "protos.git")
    built.commit("Begin", {_ENVELOPE: _LINK, _ARM: message("Arm", "float voltage", "float current")})
    return built


def test_many_projects_with_two_states_give_one_finding(
    arms: RepositoryBuilder, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Ten projects of two states differ in one field: one finding names all of them, and the matrix has two rows."""
    arms.commit("Change", {_ARM: message("Arm", "float humidity", "float current")})
    pins = tmp_path / "pins.txt"
    pins.write_text("".join(f"board{index} main~{index % 2}\n" for index in range(10)))
    protos = _written(arms) / "protos"
    (found,) = json.loads(_lint(capsys, protos, *_TREE, "--pins", pins, "--format", "json"))
    assert found["message"] == (
        "number 1 of 'Arm' is `float voltage = 1;` in 'board1', 'board3', 'board5', 'board7' and 'board9', "
        "but `float humidity = 1;` in this checkout, 'board0', 'board2', 'board4', 'board6' and 'board8': "
        "'voltage' and 'humidity' are different words"
    )
    assert [row[1:] for row in _verdicts(_lint(capsys, protos, *_TREE, "--pins", pins))] == [
        ["same", "misread 1"],
        ["misread 1", "same"],
    ]


def test_a_finding_names_declarations_commits_and_what_to_do(
    arms: RepositoryBuilder, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two projects and the checkout: each declaration with its commit, each commit with its projects."""
    arms.commit("Measure humidity", {_ARM: message("Arm", "float humidity", "float current")})
    pins = tmp_path / "pins.txt"
    pins.write_text("rover main\narm main~1\n")
    root = _written(arms)
    old, new = (git(root, "rev-parse", "--short=10", ref).strip() for ref in ("main~1", "main"))
    (found,) = json.loads(_lint(capsys, root / "protos", *_TREE, "--pins", pins, "--format", "json"))
    assert (found["id"], found["severity"], found["path"], found["line"]) == ("PIN102", "error", "arm.proto", 4)
    assert [(one["path"], one["line"], one["text"]) for one in found["also"]] == [
        (f"{old}:protos/arm.proto", 4, f"`float voltage = 1;` at {old} 2026-02-03 Begin"),
        (str(pins), 2, f"'arm' is pinned to {old} 2026-02-03 Begin"),
        (str(pins), 1, f"'rover' is pinned to {new} 2026-02-04 Measure humidity"),
    ]
    assert found["help"] == (
        "build the other projects from this checkout before they exchange messages with it, "
        "or put back `float voltage = 1;` and give the new declaration a number of its own"
    )


def test_a_broken_commit_is_read_as_far_as_possible(
    arms: RepositoryBuilder, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A pinned commit does not compile: a hint says so, and the declarations count."""
    arms.commit("Break", {_ARM: message("Arm", "float humidity", "float current", "Unknown thing")})
    arms.commit("Repair", {_ARM: message("Arm", "float voltage", "float current")})
    pins = tmp_path / "pins.txt"
    pins.write_text("arm main~1\n")
    root = _written(arms)
    broken = git(root, "rev-parse", "--short=10", "main~1").strip()
    found = json.loads(_lint(capsys, root / "protos", *_TREE, "--pins", pins, "--format", "json"))
    said = {(one["severity"], one["message"]) for one in found}
    assert (
        "hint",
        f"'arm.proto' does not compile at {broken} 2026-02-04 Break, and was read as far as possible",
    ) in said
    assert {(one["severity"], one["number"]) for one in found if one["id"] == "PIN102"} == {("error", 1)}


@pytest.mark.parametrize("width", [40, 80, 120])
def test_the_matrix_fits_the_terminal(
    arms: RepositoryBuilder,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    width: int,
) -> None:
    """Eight projects with eight states and long names: no line is longer than the terminal, and no cell is cut."""
    monkeypatch.setenv("COLUMNS", str(width))
    for index in range(1, 8):
        fields = [f"float added_{number}" for number in range(index)]
        arms.commit(str(index), {_ARM: message("Arm", "float voltage", "float current", *fields)})
    pins = tmp_path / "pins.txt"
    pins.write_text("".join(f"the-project-on-board-number-[{index}] main~{index}\n" for index in range(8)))
    out = _lint(capsys, _written(arms) / "protos", *_TREE, "--pins", pins)
    lines = out.splitlines()
    assert max(map(len, lines)) <= width
    assert out.count("same") == 8
    assert out.count("compatible") == 8 * 7
