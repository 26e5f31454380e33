"""`roverlink generate` as a user meets it: what it writes, when it writes nothing, and what it says."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from golden import ROOT, case, generate, inside, snapshot
from needs import needs_linux
from trees import edit

from roverlink.__main__ import main

_HEADER = "# Regenerate with: roverlink generate\n"
_RENAMED = [("name: wrist", "name: hand"), ("package: rover", "package: robot")]


def _changed(project: Path) -> Path:
    """The project with another topic, so that there are files to write."""
    edit(project / "mapping.yaml", "topic: arm,", "topic: left_arm,")
    return project


# --- the same input gives the same output -----------------------------------------------------------------------


@pytest.mark.slow
def test_output_depends_on_nothing_but_the_input(tmp_path: Path) -> None:
    """Two runs over this repository's table, with other hash seeds, from other folders, write the same bytes."""
    results = []
    for seed, below in ((1, ""), (2, "proto")):
        project = tmp_path / f"at_{seed}" / ("deeper" * seed)
        shutil.copytree(ROOT / "proto", project / "proto")
        shutil.copy(ROOT / "mapping.yaml", project)
        done = subprocess.run(
            [sys.executable, "-m", "roverlink", "generate", "--table", project / "mapping.yaml"],
            cwd=project / below,
            env={**os.environ, "PYTHONHASHSEED": str(seed)},
            capture_output=True,
            text=True,
        )
        assert (done.returncode, done.stderr) == (0, "")
        results.append(snapshot(project))
    assert results[0] == results[1]
    assert len(results[0]) > 100


@needs_linux
def test_protoc_is_started_again(project: Path) -> None:
    """If the process that runs protoc was killed, the next command does without it."""
    assert generate(project, "--check").code == 0
    children = {pid for file in Path("/proc/self/task").glob("*/children") for pid in file.read_text().split()}
    of_protoc = [pid for pid in children if b"_protoc_compiler" in Path(f"/proc/{pid}/cmdline").read_bytes()]
    assert of_protoc
    for pid in of_protoc:
        os.kill(int(pid), signal.SIGKILL)
    assert generate(project, "--check").code == 0


def test_an_envelope_that_moves_leaves_nothing_behind(project: Path) -> None:
    """The envelope's earlier file goes when the table names another; other files of the tree stay."""
    before = snapshot(project)
    edit(project / "mapping.yaml", "file: envelope.proto", "file: moved/envelope.proto")
    outcome = generate(project)
    assert outcome.code == 0, outcome.stderr
    assert " removed proto/envelope.proto" in outcome.stdout
    gone = before.keys() - snapshot(project).keys()
    assert {path for path in gone if path.startswith("proto/")} == {"proto/envelope.proto"}


@pytest.mark.slow
@pytest.mark.parametrize(("root", "folder"), [(".", ""), ("./proto/", "proto"), ("proto/../proto", "proto")])
def test_the_proto_root_may_be_spelled_in_any_way(root: str, folder: str, tmp_path: Path) -> None:
    """The envelope stays, and so do files elsewhere in the project that carry the header of generated files."""
    project = case("nested").write_inputs(tmp_path / "project")
    for file in (project / "proto").iterdir():
        file.rename(project / folder / file.name)
    installed = project / "venv" / "generated" / "registry.py"
    installed.parent.mkdir(parents=True)
    installed.write_text(_HEADER)
    edit(project / "mapping.yaml", "root: proto", f"root: {root}")
    assert f"   added {folder and f'{folder}/'}envelope.proto" in generate(project).stdout.splitlines()
    before = snapshot(project)
    for options in ((), ("--check",)):
        outcome = generate(project, *options)
        assert (outcome.code, outcome.stderr) == (0, "")
    assert snapshot(project) == before
    assert installed.exists()


def test_the_nearest_table_above_is_compiled(project: Path) -> None:
    """A project is found from a folder within it; a folder or a dead link of that name is not passed over."""
    below = project / "proto" / "deep"
    below.mkdir()
    outcome = generate(below, "--check")
    assert (outcome.code, outcome.stdout) == (0, "all files are up to date with ../../mapping.yaml\n")
    (below / "mapping.yaml").mkdir()
    assert generate(below).code == 2
    (below / "mapping.yaml").rmdir()
    (below / "mapping.yaml").symlink_to("nowhere")
    assert generate(below).code == 2


@pytest.mark.slow
def test_an_unchanged_run_writes_nothing(project: Path) -> None:
    """No file is touched where the table has not changed, and none tells where the project was generated."""
    for path in project.rglob("*"):
        os.utime(path, (1, 1))
    outcome = generate(project)
    assert outcome.code == 0
    assert outcome.stdout.startswith("0 ")
    assert {path.stat().st_mtime for path in project.rglob("*") if path.is_file()} == {1}
    assert generate(_changed(project)).code == 0
    assert [path for path, data in snapshot(project).items() if str(project.parent).encode() in data] == []


@pytest.mark.parametrize(
    ("old", "new"),
    [("number: 1", "number: 1.0"), ("direction: board_to_ros", "direction: sideways"), ("proto: ", "proto: Not")],
)
def test_a_mistake_in_a_row_is_not_the_end_of_its_payload(project: Path, old: str, new: str) -> None:
    """Of a row that cannot be taken as it stands, nobody is told to put its number back, or to reserve it."""
    edit(project / "mapping.yaml", old, new, 1)
    outcome = generate(project)
    assert outcome.code == 1
    assert [line for line in outcome.stderr.splitlines() if "error[" in line and "[WIR" in line] == []


# --- files that go, and files that are not ours -----------------------------------------------------------------


@pytest.mark.slow
def test_files_of_a_row_that_is_gone_are_removed(project: Path) -> None:
    """A renamed row leaves nothing behind, neither files nor empty folders, compiled modules included."""
    compiled = project / "generated" / "ros" / "rover" / "launch" / "__pycache__"
    compiled.mkdir()
    (compiled / "rover.launch.cpython-310.pyc").write_bytes(b"compiled")
    for old, new in _RENAMED:
        edit(project / "mapping.yaml", old, new)
    before = set(snapshot(project))
    outcome = generate(project)
    assert "generated/handlers/wrist.py" in before - set(snapshot(project))
    assert not (project / "generated" / "ros" / "rover").exists()
    assert " removed generated/handlers/wrist.py" in outcome.stdout.splitlines()
    fresh = case("nested").write_inputs(project.parent / "fresh")
    shutil.copy(project / "mapping.yaml", fresh)
    assert generate(fresh).code == 0
    assert snapshot(fresh) == snapshot(project)


@pytest.mark.slow
def test_files_of_the_user_stay(project: Path) -> None:
    """What users put beside the generated files is left alone, and so are those of another project or repository."""
    theirs = {
        "generated/notes.txt": b"Regenerate with care\n",
        "generated/handlers/own.py": b"x = 1\n",
        "generated/binary.dat": bytes(range(256)),
        "generated/ros/rover/msg/Own.msg": b"int32 x\n",
    }
    of_others = ["other/mapping.yaml", "other/generated/arm.py", "clone/.git/HEAD", "clone/arm.py"]
    theirs |= {f"proto/{path}": f"{_HEADER}x = 1\n".encode() for path in of_others}
    for path, data in theirs.items():
        (project / path).parent.mkdir(parents=True, exist_ok=True)
        (project / path).write_bytes(data)
    edit(project / "mapping.yaml", *_RENAMED[1])
    assert generate(project).code == 0
    assert theirs.items() <= snapshot(project).items()
    assert generate(project, "--check").code == 0


@pytest.mark.slow
def test_overwriting_is_asked_for(project: Path) -> None:
    """A user's file in the place of a generated one stays until the user says `--overwrite`."""
    theirs = project / "docs" / "messages.md"
    theirs.write_text("# Our own page\n")
    before = snapshot(project)
    outcome = generate(project)
    assert outcome.code == 2
    assert "docs/messages.md: fatal[OUT108] the file exists and was not generated\n" in outcome.stderr
    assert "`roverlink generate --overwrite`" in outcome.stderr
    assert snapshot(project) == before
    assert generate(project, "--overwrite").code == 0
    assert "Our own page" not in theirs.read_text()
    assert generate(project, "--check").code == 0


def test_an_edited_table_does_not_replace_a_foreign_envelope(project: Path) -> None:
    """`retire` writes the envelope too; neither it nor mapping.yaml changes if the envelope is the user's."""
    envelope = project / "proto" / "envelope.proto"
    envelope.write_text("".join(envelope.read_text().splitlines(keepends=True)[2:]))
    before = snapshot(project)
    with inside(project):
        assert main(["number", "retire", "1"]) == 2
    assert snapshot(project) == before


@pytest.mark.slow
def test_files_without_a_header_are_known_from_the_ledger(tmp_path: Path) -> None:
    """What a user's template makes needs no header: mapping.lock lists it, so the next run replaces it."""
    project = case("own_templates").write_inputs(tmp_path)
    assert generate(project).code == 0
    ledger = project / "mapping.lock"
    assert "\n  file generated/include/Probe.csv\n" in ledger.read_text()
    template = project / "firmware" / "include" / "{message}.csv.j2"
    template.write_text("name,type\n" + template.read_text())
    assert generate(project).code == 0
    assert (project / "generated" / "include" / "Probe.csv").read_text() == "name,type\ndepth_m,float32\n"
    ledger.unlink()
    assert generate(project).code == 0  # nothing changes, so nothing is replaced
    ledger.unlink()
    template.write_text("type,name\n")
    assert "generated/include/Probe.csv: fatal[OUT108]" in generate(project).stderr
    assert not ledger.exists()


@pytest.mark.slow
def test_a_vendored_runtime_goes_whole(project: Path) -> None:
    """Without the option, all its files are removed, also those without a header; CMake asks if the folder exists."""
    before = snapshot(project)
    assert generate(project, "--vendor-runtime").code == 0
    for file in ("native/flags", "runtime/middleware/zenoh.py"):
        assert any(f"vendor/runtime/roverlink/{file}" in path for path in snapshot(project))
    assert generate(project).code == 0
    assert snapshot(project) == before
    assert not [*project.rglob("vendor")]


@pytest.mark.slow
def test_an_envelope_outside_the_project_is_not_written(tmp_path: Path) -> None:
    """With `root: ..` the envelope is another project's: it is neither replaced, nor removed, nor shown by --check."""
    project = case("nested").write_inputs(tmp_path / "project")
    for file in (project / "proto").iterdir():
        file.rename(tmp_path / file.name)
    (tmp_path / "envelope.proto").write_text(f"//{_HEADER[1:]}// the neighbour's secret\n")
    edit(project / "mapping.yaml", "root: proto", "root: ..")
    before = snapshot(tmp_path)
    for options in ((), ("--check",), ("--overwrite",)):
        outcome = generate(project, *options)
        assert outcome.code == 1
        assert "../envelope.proto: error[OUT109] cannot write '../envelope.proto'" in outcome.stderr
        assert "secret" not in outcome.stdout + outcome.stderr
    assert snapshot(tmp_path) == before


@pytest.mark.parametrize(
    ("link", "target"),
    [
        *(("docs", "../outside"), ("docs/messages.md", "../outside"), ("generated", "../outside")),
        *(("generated", ".git/hooks"), ("generated/registry.py", ".git/hooks")),
    ],
)
def test_no_file_is_written_through_a_link(project: Path, link: str, target: str) -> None:
    """A link out of the project, or into git's own folder, is refused, even with `--overwrite`."""
    for folder in (project.parent / "outside", project / ".git" / "hooks"):
        folder.mkdir(parents=True)
    path = project / link
    shutil.rmtree(path) if path.is_dir() else path.unlink()
    path.symlink_to((project / target / "registry.py") if path.suffix else (project / target))
    before = snapshot(project.parent)
    outcome = generate(project, "--overwrite")
    assert (outcome.code, "error[OUT109]" in outcome.stderr) == (1, True)
    assert snapshot(project.parent) == before


def test_a_link_inside_the_project_stays_a_link(project: Path) -> None:
    """A generated file that the user keeps elsewhere in the project, behind a link, is replaced there."""
    elsewhere, page = project / "site.md", project / "docs" / "messages.md"
    page.rename(elsewhere)
    page.symlink_to(elsewhere)
    assert generate(_changed(project)).code == 0
    assert page.is_symlink()
    assert "left_arm" in elsewhere.read_text()


def test_a_pipe_in_the_place_of_a_file_is_a_finding(project: Path) -> None:
    """A pipe is not read, which would never end, and not replaced."""
    page = project / "docs" / "messages.md"
    page.unlink()
    os.mkfifo(page)
    outcome = generate(project, "--overwrite")
    assert outcome.code == 2
    why = "it is not a regular file, but a folder, a pipe or a device"
    assert f"docs/messages.md: fatal[OUT101] cannot read the file: {why}\n" in outcome.stderr
    assert page.is_fifo()


# --- the check --------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("git") is None, reason="need git (apt-get install git)")
def test_the_diff_of_check_is_the_cure(project: Path) -> None:
    """Whatever differs is exit code 1 and part of a diff; applied as a patch, this makes all as the table says."""
    row = "  - {number: 9, name: second_wrist, proto: Wrist, topic: second_wrist, direction: board_to_ros}\n"
    stale, gone = "generated/handlers/leg.py", ("generated/ros/rover/msg/Arm.msg", "generated/registry.py")
    with (project / "mapping.yaml").open("a") as table:
        table.write(row)
    (project / stale).write_text(f"{_HEADER}x = 1\n")
    for path in gone:
        (project / path).unlink()
    edit(project / "docs" / "messages.md", "Arm", "Leg")
    (project / "generated" / "handlers" / "arm.py").write_text("no line break at the end")
    (project / "proto" / "envelope.proto").write_text("")
    before = snapshot(project)
    outcome = generate(project, "--check")
    assert outcome.code == 1
    assert snapshot(project) == before
    assert f"--- a/{stale}\n+++ /dev/null\n@@ " in outcome.stdout
    for path in (*gone, "generated/handlers/second_wrist.py"):
        assert f"--- /dev/null\n+++ b/{path}\n@@ " in outcome.stdout
    for path in ("docs/messages.md", "generated/handlers/arm.py", "mapping.lock", "proto/envelope.proto"):
        assert f"--- a/{path}\n+++ b/{path}\n@@ " in outcome.stdout
    assert "\n+  9: second_wrist Wrist on second_wrist\n" in outcome.stdout
    subprocess.run(["git", "apply", "-"], cwd=project, input=outcome.stdout, text=True, check=True)
    assert generate(project, "--check").code == 0


# --- what cannot be written -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "method", "error", "where"),
    [
        (2, "write_bytes", OSError(28, "No space left on device"), "\ngenerated/handlers/arm.py"),
        (3, "replace", OSError(13, "Permission denied"), "\ngenerated/handlers/arm.py"),
        (4, "replace", OSError(1, "Operation not permitted"), "\ngenerated/registry.py"),
    ],
    ids=["a full disk", "a read-only folder", "a file of another user"],
)
def test_a_file_that_cannot_be_written_is_a_finding(
    project: Path, monkeypatch: pytest.MonkeyPatch, call: int, method: str, error: OSError, where: str
) -> None:
    """It is named; files that were replaced before it get their old content back, and no other is left behind."""
    before = snapshot(_changed(project))
    _fail_at(call, monkeypatch, method, error, project)
    outcome = generate(project)
    assert outcome.code == 2
    assert f"{where}: fatal[OUT101] cannot write the file: {error.strerror}\n" in outcome.stderr
    assert snapshot(project) == before


def _fail_at(call: int, monkeypatch: pytest.MonkeyPatch, name: str, error: OSError, within: Path) -> None:
    """Let the call of a method of `Path` with this number fail; only calls for paths within a folder count."""
    original, calls = getattr(Path, name), []

    def failing(*args: Any, **kwargs: Any) -> Any:
        if str(args[0]).startswith(str(within)):
            calls.append(args)
            if len(calls) == call:
                raise error
        return original(*args, **kwargs)

    monkeypatch.setattr(Path, name, failing)


def test_a_file_is_replaced_and_not_written_into(project: Path) -> None:
    """Who has the old file open reads the old text to its end; the new one has the old one's permissions."""
    handler = project / "generated" / "handlers" / "arm.py"
    handler.chmod(0o640)
    old = handler.read_bytes()
    with handler.open("rb") as reader:
        assert generate(_changed(project)).code == 0
        assert reader.read() == old
    assert b"left_arm" in handler.read_bytes()
    assert handler.stat().st_mode & 0o777 == 0o640
