"""Accepting the past of numbers with `lint --history --accept`, in projects with a table and in trees without one."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from repositories import git

from roverlink.generator.lock import checksum

_IDENTITY = ("-c", "user.name=A", "-c", "user.email=a@example.com")
_TYPES = """\
message Imu { float accel_x = 1; float left_speed = 2; float speed = 3; map<string, Gps> places = 4; Mode mode = 5; }
message Gps { double latitude = 1; double longitude = 2; uint32 satellites = 3; }
message Wind { string direction = 1; bytes raw = 2; bool gusty = 3; }
message Ph { float acidity = 1; string probe = 2; }
message Load { int32 ticks = 1; bytes unit = 2; }
enum Mode { IDLE = 0; DRIVE = 1; }
"""
_FIRST = ("Imu imu = 1;", "Gps gps = 2;", "Ph ph = 3;")
_NOW = ("Imu imu = 1;", "Wind wind = 2;", "Load load = 3;")

Said = tuple[int, str, str]
Run = Callable[..., Said]


@dataclass(frozen=True)
class Repository:
    """A repository in the current folder with an envelope in `protos/`, and with a table if `table` is set."""

    run: Run
    package: str
    table: bool

    def full(self, name: str) -> str:
        """Return the full name of a type."""
        return f"{self.package}.{name}" if self.package else name

    def write(self, *members: str, types: str = _TYPES) -> None:
        """Write the .proto files, and the table with a row for each payload."""
        package = f"package {self.package};\n" if self.package else ""
        start = f'syntax = "proto3";\n{package}'
        Path("protos").mkdir(exist_ok=True)
        Path("protos/types.proto").write_text(start + types)
        body = "\n".join(f"    {member}" for member in members)
        start = f"// Regenerate with: roverlink generate\n{start}"  # so that `generate` may replace the file
        Path("protos/envelope.proto").write_text(
            f'{start}import "types.proto";\nmessage Env {{\n  oneof payload {{\n{body}\n  }}\n}}\n'
        )
        if self.table:
            rows = []
            for type, name, _, number in (member.rstrip(";").split() for member in members):
                row = f"number: {number}, name: {name}, proto: {self.full(type)}, topic: {name}"
                rows.append(f"  - {{{row}, direction: board_to_ros}}\n")
            Path("mapping.yaml").write_text(
                "version: 1\nproto: {root: protos}\n"
                f"envelope: {{file: envelope.proto, message: {self.full('Env')}, oneof: payload}}\n"
                f"ros: {{package: rover}}\npeers: {{board: {{}}}}\nmessages:\n{''.join(rows)}"
            )

    def commit(self, *members: str, types: str = _TYPES) -> None:
        """Write the files and commit everything."""
        self.write(*members, types=types)
        commit_all()

    def lint(self, *arguments: str) -> Said:
        """Run `lint --history` with the arguments that name what to check."""
        return self.run("lint", "--history", *self.subject, *arguments)

    @property
    def subject(self) -> tuple[str, ...]:
        """The arguments that name what to check."""
        return () if self.table else ("protos", "--message", self.full("Env"))

    @property
    def ledger(self) -> Path:
        """The file that holds the accepted numbers."""
        return Path("mapping.lock" if self.table else "protos/accepted-numbers.lock")

    def found(self, *arguments: str) -> list[tuple[str, str, int]]:
        """Return rule, type and number of each finding that is more than a hint."""
        return [(one["id"], one["message_type"], one["number"]) for one in self.findings(*arguments)]

    def findings(self, *arguments: str) -> list[dict[str, Any]]:
        """Return each finding that is more than a hint."""
        _, out, err = self.lint(*arguments, "--format", "json")
        assert err == ""
        return [one for one in json.loads(out) if one["severity"] != "hint"]


def commit_all() -> None:
    """Commit everything in the current folder."""
    git(Path(), "add", "--all")
    git(Path(), *_IDENTITY, "commit", "--quiet", "--allow-empty", "--message", "Change")


def _repository(run: Run, package: str, table: bool, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Repository:
    folder.mkdir()
    monkeypatch.chdir(folder)
    git(folder, "init", "--quiet", "--initial-branch", "main")
    return Repository(run, package, table)


def _reused(repository: Repository) -> Repository:
    """Give the numbers 2 and 3 two meanings, before there is a table."""
    table, bare = repository, Repository(repository.run, repository.package, False)
    for members in (_FIRST, _FIRST[:1], _NOW):
        bare.commit(*members)
    table.write(*_NOW)
    if table.table:
        assert table.run("generate")[0] == 0
    commit_all()
    return table


@pytest.fixture(params=["table-package", "tree"])
def reused(request: pytest.FixtureRequest, run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Repository:
    """A repository in which the numbers 2 and 3 of the envelope were reused."""
    kind, _, package = request.param.partition("-")
    repository = _repository(run, package and "rover", kind == "table", tmp_path / "repository", monkeypatch)
    return _reused(repository)


@pytest.fixture
def tree(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Repository:
    """An empty repository for a tree without a table, in a package."""
    return _repository(run, "rover", False, tmp_path / "repository", monkeypatch)


@pytest.fixture
def project(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Repository:
    """A project in a package, in which the numbers 2 and 3 of the envelope were reused."""
    return _reused(_repository(run, "rover", True, tmp_path / "repository", monkeypatch))


def _status() -> str:
    return git(Path(), "status", "--porcelain").strip()


# --- one number ---


@pytest.mark.slow
def test_one_number_is_accepted(reused: Repository) -> None:
    """Only the accepted number is quiet, `generate` goes on as before, and a third meaning of the number is found."""
    envelope, name = reused.full("Env"), str(reused.ledger)
    assert reused.found() == [("HIS101", envelope, 2), ("HIS101", envelope, 3)]
    help = next(one["help"] for one in reused.findings() if one["number"] == 2)
    command = "roverlink lint --history " + ("--accept 2" if reused.table else f"protos --accept {envelope}:2")
    assert f"`{command}`" in help
    code, out, err = reused.run(*command.split()[1:], "--reason", "the GPS board\n was never built")
    assert (code, err) == (0, "")
    assert f"accepted in {Path(name).name};" in out
    line = (
        f"  {envelope} 2: {reused.full('Gps')} gps | {reused.full('Wind')} wind now -- the GPS board was never built\n"
    )
    assert line in reused.ledger.read_text()
    assert _status() == (f"M {name}" if reused.table else f"?? {name}")
    assert reused.found() == [("HIS101", envelope, 3)]
    if reused.table:
        assert reused.run("generate", "--check")[0] == 0
        assert reused.run("generate")[0] == 0
        assert _status() == f"M {name}"
    assert reused.run("lint", *reused.subject)[0] == 0
    assert reused.run("lint", *reused.subject, "--against", "HEAD")[0] == 0
    commit_all()
    assert reused.lint("--accept")[0] == 0
    assert reused.lint()[0] == 0
    commit_all()
    reused.commit("Imu imu = 1;", "Ph ph = 2;", "Load load = 3;")
    (found,) = (one for one in reused.findings() if one["id"] == "HIS101")
    assert (found["message_type"], found["number"]) == (envelope, 2)
    assert "accepted: the GPS board was never built" in found["help"]


@pytest.mark.slow
def test_what_was_accepted_is_known_to_all(reused: Repository, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same question writes the same bytes; the committed file settles the numbers, also for clones and for refs.

    A payload's message that is only renamed after that is no further meaning, and `generate` goes on.
    """
    number = f"{reused.full('Env')}:2"
    assert reused.lint("--accept", "--reason", "known")[0] == 0
    text = reused.ledger.read_text()
    for arguments in (["--accept"], ["--accept", number]):
        assert reused.lint(*arguments)[0] == 0
        assert reused.ledger.read_text() == text
    assert reused.lint("--accept", number, "--reason", "better known")[0] == 0
    assert reused.ledger.read_text().splitlines()[:-1] == [
        line.replace("known", "better known") if number.replace(":", " ") in line else line
        for line in text.splitlines()[:-1]
    ]
    commit_all()
    git(tmp_path, "clone", "--quiet", str(Path.cwd()), "clone")
    with monkeypatch.context() as elsewhere:
        elsewhere.chdir(tmp_path / "clone")
        codes = [reused.run("lint", *reused.subject, "--history", *ref)[0] for ref in ((), ("HEAD",), ("HEAD~1",))]
        assert codes == [0, 0, 1]
    reused.commit("Imu imu = 1;", "WindInfo wind = 2;", "Load load = 3;", types=_TYPES.replace("Wind", "WindInfo"))
    assert [one for one in reused.found() if one[1] == reused.full("Env")] == []
    if reused.table:
        assert reused.run("generate")[0] == 0
        assert reused.lint()[0] == 0


# --- kinds of findings ---


@pytest.mark.slow
def test_each_kind_of_finding_is_accepted(tree: Repository) -> None:
    """Reused numbers, replaced contents and doubtful names are settled one by one, and new contents are found."""
    tree.commit(*_FIRST)
    after = _TYPES.replace("left_speed", "left_current").replace(" speed", " velocity").replace("DRIVE", "ARM")
    gps = after.index("message Gps")
    after = after[:gps] + after[gps:].replace(
        "double latitude = 1; double longitude = 2; uint32 satellites = 3;",
        "string sentence = 1; bytes almanac = 2; bool fixed = 3;",
    )
    tree.commit(*_FIRST, types=after)
    # The fields of the other message have numbers of their own.
    of_gps = {("HIS101", "rover.Gps", number) for number in (1, 2, 3)}
    wanted = {
        ("HIS101", "rover.Imu", 2),
        ("HIS101", "rover.Mode", 1),
        ("HIS103", "rover.Env", 2),
        ("HIS105", "rover.Imu", 3),
    }
    found = set(tree.found())
    assert {one for one in found if one[0] != "HIS103" or one[1] == "rover.Env"} == wanted | of_gps
    for rule, type, number in sorted(found):
        assert tree.lint("--accept", f"{type}:{number}")[0] == 0
        found.remove((rule, type, number))
        assert set(tree.found()) == found
    commit_all()
    again = after.replace(
        "string sentence = 1; bytes almanac = 2; bool fixed = 3;", "double a = 1; float b = 2; string c = 3;"
    )
    tree.commit(*_FIRST, types=again)
    assert ("HIS103", "rover.Env", 2) in tree.found()


@pytest.mark.slow
def test_a_repaired_number_is_accepted(tree: Repository) -> None:
    """It is only a hint, and accepting it settles it, with the meaning that it has again."""
    for members in (_FIRST, ("Imu imu = 1;", "Wind wind = 2;", "Ph ph = 3;"), _FIRST):
        tree.commit(*members)
    assert (tree.found(), "hint[HIS101]" in tree.lint("--all")[1]) == ([], True)
    assert tree.lint("--accept", "2")[0] == 0
    assert "  rover.Env 2: rover.Gps gps now | rover.Wind wind\n" in tree.ledger.read_text()
    assert tree.lint("--all")[1] == "No problems found.\n"


@pytest.mark.slow
def test_a_rename_is_one_meaning(project: Repository) -> None:
    """A rename that the lint takes for another meaning passes `generate` and `--against` once it is accepted."""
    assert project.lint("--accept")[0] == 0
    commit_all()
    renamed = _TYPES.replace("left_speed", "left_current").replace("DRIVE", "ARM")
    project.write(*_NOW, types=renamed)
    assert {one[0] for one in project.found()} == {"HIS101"}
    assert project.run("generate")[0] == 1
    code, _, err = project.lint("--accept", "rover.Imu:2", "rover.Mode:1", "--reason", "only better names")
    assert (code, err) == (0, "")
    assert project.lint("--against", "HEAD")[0] == 0
    assert project.run("generate", "--check")[0] == 0
    commit_all()
    # A third name, and the first name again.
    project.write(*_NOW, types=renamed.replace("left_current", "wheel_torque"))
    assert ("HIS101", "rover.Imu", 2) in project.found()
    project.write(*_NOW)
    assert {("WIR111", "rover.Imu", 2), ("WIR112", "rover.Mode", 1)} <= set(project.found())
    assert project.lint("--accept", "rover.Imu:2", "rover.Mode:1")[0] == 0
    assert project.lint()[0] == 0


@pytest.mark.slow
def test_other_types_of_one_number(tree: Repository) -> None:
    """A renamed map is accepted, whose type the history spells in another way than today's schema.

    `repeated` reads other bytes, so the same name with it is a further meaning.
    """
    tree.commit(*_FIRST)
    types = _TYPES.replace("float accel_x", "string accel_x").replace("places", "victims")
    tree.commit(*_FIRST, types=types)
    assert tree.found() == [("HIS101", "rover.Imu", 1), ("HIS101", "rover.Imu", 4)]
    assert tree.lint("--accept")[0] == 0
    assert tree.lint()[0] == 0
    tree.commit(*_FIRST, types=types.replace("string accel_x", "repeated string accel_x"))
    assert tree.found() == [("HIS101", "rover.Imu", 1)]


# --- numbers that are free ---


@pytest.mark.slow
def test_a_burned_number_that_is_free_is_given_to_nobody(tree: Repository) -> None:
    """A free number is refused for a field, an enum value and a payload, also with an earlier meaning."""
    before = _TYPES.replace("IDLE = 0; DRIVE = 1;", "IDLE = 0; DRIVE = 1; STOP = 2;")
    after = before.replace("left_speed", "left_current").replace("DRIVE", "ARM")
    gone = after.replace("float left_current = 2;", "reserved 2;").replace("ARM = 1;", "reserved 1;")
    closed = ("Imu imu = 1;", "Ph ph = 3;")
    for types, members in ((before, _FIRST), (after, ("Imu imu = 1;", "Wind wind = 2;", "Ph ph = 3;"))):
        tree.commit(*members, types=types)
    tree.write(*closed, types=gone)
    envelope = Path("protos/envelope.proto")
    envelope.write_text(envelope.read_text().replace("  oneof", "  reserved 2;\n  oneof"))
    commit_all()
    assert tree.lint("--accept")[0] == 0
    assert " now" not in tree.ledger.read_text()
    assert tree.lint()[0] == 0
    assert tree.run("number", "next", *tree.subject)[1] == "4\n"
    tree.write(*_FIRST, types=before)
    taken = {("ENV110", "rover.Env", 2), ("WIR111", "rover.Imu", 2), ("WIR112", "rover.Mode", 1)}
    assert set(tree.found()) == taken
    code, out, _ = tree.run("lint", *tree.subject)
    assert code == 1
    assert "number 2 of 'rover.Imu' was used for 'left_speed' (float) and 'left_current' (float) in the past" in out


# --- projects ---


@pytest.mark.slow
def test_a_number_that_is_free_gets_reserved(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The ledger takes note of a number that no payload has today, and the envelope reserves it."""
    project = _repository(run, "rover", True, tmp_path / "repository", monkeypatch)
    bare = Repository(run, "rover", False)
    bare.commit("Ph old = 9;")
    bare.commit("Load other = 9;")
    _reused(project)
    code, out, _ = project.lint("--accept")
    assert (code, "changed mapping.lock" in out) == (0, True)
    assert "  rover.Env 9: rover.Ph old | rover.Load other\n" in project.ledger.read_text()
    assert "  reserved 9;  // rover.Ph, rover.Load\n" in Path("protos/envelope.proto").read_text()
    assert project.lint()[0] == 0


@pytest.mark.slow
def test_a_ledger_of_an_earlier_version_keeps_a_number_in_use(project: Repository) -> None:
    """Earlier versions wrote types without the package, and lost which meaning the number had."""
    text = project.ledger.read_text().rpartition("checksum:")[0]
    text += "burned:\n  rover.Env 2: Gps gps | Wind wind\n  rover.Env 3: .rover.Ph ph | .rover.Load load\n\n"
    project.ledger.write_text(f"{text}checksum: {checksum(text)}\n")
    for command in (["generate"], ["lint"], ["lint", "--history"], ["lint", "--against", "HEAD"]):
        code, out, err = project.run(*command)
        assert (code, err) == (0, ""), (command, out, err)


@pytest.mark.slow
def test_init_takes_the_accepted_numbers_over(tree: Repository) -> None:
    """A project that starts from a tree has the accepted numbers in its own ledger, and the tree's file is gone."""
    _reused(tree)
    assert tree.lint("--accept", "--reason", "known")[0] == 0
    line = next(line for line in tree.ledger.read_text().splitlines() if "rover.Env 2:" in line)
    commit_all()
    code, out, err = tree.run("init", "--from", "protos")
    assert (code, err, "another meaning" in out) == (0, "", False)
    assert not tree.ledger.exists()
    assert line in Path("mapping.lock").read_text().splitlines()
    commit_all()
    assert [one for one in tree.run("lint", "--history")[1].splitlines() if "HIS101" in one] == []
    assert tree.run("generate", "--check")[0] == 0


# --- bad input ---


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--accept", "rover.Env:9"], "fatal[RET104] --history reports nothing about number 9 of 'rover.Env'"),
        (
            ["--accept", "rover.Env:2", "rover.Nobody:2"],
            "--accept takes the reported numbers: rover.Env:2, rover.Env:3",
        ),
        (["--accept", "two"], "--accept: 'two' is not a number"),
        (["--accept", "NAM103:rover.Kind"], "fatal[RET104] the lint has no finding of NAM103 about"),
        (["--accept", "99999999999"], "--accept: '99999999999' is not a number"),
        (["--accept", "protos"], "write a folder of .proto files before --accept"),
        (["--accept", "2", "--reason", " \n"], "--reason needs a text"),
        (["--accept", "2", "--reason", "\x1b[31m"], "--reason needs a text of printable characters"),
        (["--reason", "known"], "name them with --accept"),
    ],
)
def test_what_cannot_be_accepted(tree: Repository, arguments: list[str], said: str) -> None:
    """A number without a finding, a word that is no number and an unreadable reason: exit code 2, nothing written."""
    _reused(tree)
    code, out, err = tree.lint(*arguments)
    assert (code, said in out + err) == (2, True)
    assert _status() == ""


@pytest.mark.slow
def test_a_rule_is_accepted_in_a_tree(tree: Repository) -> None:
    """A clash is one finding, which the file in the tree makes a known one, or `--exclude` leaves out."""
    tree.write(*_FIRST)
    Path("protos/clash.proto").write_text('syntax = "proto3";\npackage rover;\nenum Kind { NONE = 0; Imu = 1; }\n')
    code, out, _ = tree.run("lint", *tree.subject)
    assert (code, out.count("error["), "error[NAM103]" in out) == (1, 1, True)
    assert tree.run("lint", *tree.subject, "--exclude", "clash.proto")[:2] == (0, "No problems found.\n")
    for about in ("NAM103", "NAM103:rover.Kind", "NAM103:clash.proto"):
        assert tree.run("lint", *tree.subject, "--accept", about, "--reason", "not ours")[0] == 0
        assert f"  rule {about.replace(':', ' ')} -- not ours\n" in tree.ledger.read_text()
        assert tree.run("lint", *tree.subject)[1].startswith("No new problems found (1 known problem")
        tree.ledger.unlink()


def test_a_reuse_of_an_open_branch_is_not_accepted_elsewhere(tree: Repository) -> None:
    """Accepting a number on one branch says nothing about what another branch does with it later."""
    _reused(tree)
    git(Path(), "checkout", "--quiet", "-b", "feature")
    tree.commit(_NOW[0], "Water water = 2;", types=f"{_TYPES}message Water {{ int32 depth = 1; }}\n")
    git(Path(), "checkout", "--quiet", "-")
    assert tree.lint("--accept", "rover.Env:2")[0] == 0
    assert "water" not in tree.ledger.read_text()


@pytest.mark.slow
def test_a_tree_without_the_name_of_its_envelope(tree: Repository) -> None:
    """`18` is no number of any message; and without the file of accepted numbers, free ones would look unused."""
    _reused(tree)
    code, out, _ = tree.run("lint", "--history", "protos", "--accept", "2")
    assert (code, "name the envelope with --message" in out) == (2, True)
    assert tree.run("lint", "--history", "protos", "--accept", "rover.Env:2")[0] == 0
    commit_all()
    tree.ledger.unlink()
    assert "[LED104]" in tree.run("lint", *tree.subject)[1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "rule"),
    [("Numbers of our team\n", "LED102"), ("version: 1\n\nchecksum: 00\n", "LED103"), ("\xff", "LED101")],
)
def test_a_damaged_file_is_reported_and_kept(tree: Repository, text: str, rule: str) -> None:
    """A file that roverlink did not write as it is now is a finding of every lint, and `--accept` leaves it alone."""
    _reused(tree)
    tree.ledger.write_bytes(text.encode("latin-1"))
    code, out, _ = tree.run("lint", *tree.subject)
    assert code in (1, 2)
    assert f"[{rule}]" in out
    assert "protos/accepted-numbers.lock" in out
    code, out, _ = tree.lint("--accept")
    assert (code, f"[{rule}]" in out) == (2, True)
    assert tree.ledger.read_bytes() == text.encode("latin-1")


@pytest.mark.slow
def test_both_sides_of_a_merge_conflict_count(tree: Repository) -> None:
    """Branches that accepted different numbers have a conflict; accepting one again writes the file anew."""
    _reused(tree)
    git(Path(), "checkout", "--quiet", "-b", "other")
    assert tree.lint("--accept", "2")[0] == 0
    commit_all()
    git(Path(), "checkout", "--quiet", "main")
    assert tree.lint("--accept", "3")[0] == 0
    commit_all()
    subprocess.run(["git", *_IDENTITY, "merge", "--quiet", "other"], check=False, capture_output=True)
    assert "<<<<<<<" in tree.ledger.read_text()
    assert tree.lint()[0] == 0
    assert tree.lint("--accept", "2")[0] == 0
    assert "<<<<<<<" not in tree.ledger.read_text()
    assert tree.ledger.read_text().count("rover.Env ") == 2
    assert tree.lint()[0] == 0


def test_a_file_that_does_not_compile_hides_no_meaning(tree: Repository) -> None:
    """What a number means today must be known before its past is accepted."""
    _reused(tree)
    file = Path("protos/envelope.proto")
    file.write_text(file.read_text().replace("message Env {", "message Env { Nobody nobody = 9;"))
    code, out, _ = tree.run("lint", "--history", "protos", "--accept", "rover.Env:2")
    assert (code, "[PRO101]" in out) == (2, True)
    assert not tree.ledger.exists()
