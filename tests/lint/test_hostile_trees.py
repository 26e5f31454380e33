"""Pull requests of strangers: nothing endless or private is read, and none of their files is run."""

from __future__ import annotations

import contextlib
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import IO, NoReturn

import pytest
from golden import PROBE_PROTO, PROBE_TABLE, generate
from polling import PATIENCE_S

from roverlink.__main__ import main

_ROOT = Path(__file__).parents[2]
_TABLE = f"{PROBE_TABLE}targets: [python, nanopb]\n"
_SECRET = 'syntax = "proto3";\n\nmessage TopSecret {\n  float hunter_two = 1\n}\n'
_COMMIT = ["git", "-c", "user.name=A", "-c", "user.email=a@example.com", "commit", "--quiet", "-m", "Change"]
_MEMORY = 150 << 20  # bytes more than this process has
_SECONDS = int(PATIENCE_S)

# What the installed script does: unlike `python -m`, it does not import from the current folder.
_SCRIPT = "import sys; sys.path.remove(''); from roverlink.__main__ import main; sys.exit(main())"


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a project in a git repository, beside files that are none of its business."""
    top = tmp_path_factory.mktemp("original")
    (top / "secret").write_text(_SECRET)
    (top / "elsewhere").mkdir()
    (top / "elsewhere" / "secret.proto").write_text(_SECRET)
    folder = top / "project"
    (folder / "proto").mkdir(parents=True)
    (folder / "mapping.yaml").write_text(_TABLE)
    (folder / "proto" / "probe.proto").write_text(PROBE_PROTO)
    subprocess.run(["git", "init", "--quiet", str(folder)], check=True)
    with (folder / ".git" / "config").open("a") as config:
        config.write("# TopSecret hunter_two\n")
    assert generate(folder).code == 0
    return top


@pytest.fixture
def project(original: Path, tmp_path: Path) -> Path:
    """A copy of the generated project."""
    shutil.copytree(original, tmp_path, symlinks=True, dirs_exist_ok=True)
    return tmp_path / "project"


def _run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a command in a fork of this process, which has loaded most of it, in bounded time and memory."""
    with tempfile.TemporaryFile("w+") as output, tempfile.TemporaryFile("w+") as errors:
        child = os.fork()
        if not child:
            _run_and_exit(folder, arguments, output, errors)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        said = [file.seek(0) or file.read() for file in (output, errors)]
    return _judged(folder, subprocess.CompletedProcess(arguments, code, *said))


def _run_and_exit(folder: Path, arguments: tuple[str, ...], output: IO[str], errors: IO[str]) -> NoReturn:
    code = -1
    try:
        os.dup2(os.pipe()[0], 0)  # as a terminal at which nobody types
        os.dup2(output.fileno(), 1)
        os.dup2(errors.fileno(), 2)
        os.chdir(folder)
        most = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize() + _MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        signal.alarm(_SECONDS)
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            code = main(arguments)
    except BaseException:  # noqa: BLE001  # a fork of pytest ends here
        traceback.print_exc(file=errors)
    finally:
        output.flush()
        errors.flush()
        os._exit(code)


def _run_alone(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a command as the installed script does, in a process that imports everything itself."""
    command = [sys.executable, "-c", _SCRIPT, *arguments]
    environment = {**os.environ, "PYTHONPATH": str(_ROOT), "MARK": str(folder / "MARK")}
    return _judged(folder, subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True))


def _judged(folder: Path, done: subprocess.CompletedProcess[str]) -> subprocess.CompletedProcess[str]:
    assert "Traceback" not in done.stderr
    assert "hunter_two" not in done.stdout + done.stderr
    assert "TopSecret" not in done.stdout + done.stderr
    assert not (folder / "MARK").exists(), "a file of the pull request was run"
    return done


def _expect(done: subprocess.CompletedProcess[str], code: int, said: str, start: str = "") -> None:
    """A command ended with an exit code, and one of its lines has the words, perhaps at or behind a start."""
    lines = (done.stdout + done.stderr).splitlines()
    assert done.returncode == code
    assert any(said in line and start in line for line in lines), "\n".join(lines)


def _huge(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(100_000_000)


_OUT = "it is a link that leads out of the repository"
# Each test runs commands on a project of its own.
pytestmark = pytest.mark.slow

_KINDS: dict[str, tuple[Callable[[Path], object], str]] = {
    "pipe": (os.mkfifo, "it is not a regular file"),
    "endless device": (lambda path: path.symlink_to("/dev/zero"), _OUT),
    "link out of the repository": (
        lambda path: path.symlink_to(path.parents[path.parts[::-1].index("project")] / "secret"),
        _OUT,
    ),
    "link to git's settings": (
        lambda path: path.symlink_to(os.path.relpath(_top(path) / ".git" / "config", path.parent)),
        "it leads into the folder .git",
    ),
    "100 MB": (_huge, "it has 100000000 bytes; files of more than"),
    "folder": (Path.mkdir, "it is not a regular file"),
}
_SOME = ("pipe", "link out of the repository", "100 MB")
"""Kinds for places that one function reads; `test_lint_names_and_skips_hostile_files` tries all of them."""
_LINT, _CHECK = ("lint",), ("generate", "--check")
_BOTH = pytest.mark.parametrize("command", [_LINT, _CHECK])
_SOME_KINDS = pytest.mark.parametrize("kind", _SOME)
_WRONG = 'syntax = "proto3";\n\nmessage Wrong {\n  Missing x = 1;\n}\n'


def _top(path: Path) -> Path:
    return next(folder for folder in path.parents if (folder / ".git").exists())


def _plant(path: Path, kind: str) -> str:
    """Put a hostile file in the place of ``path``, and return what roverlink has to say of it."""
    path.unlink(missing_ok=True)
    _KINDS[kind][0](path)
    return _KINDS[kind][1]


@pytest.mark.parametrize("kind", _KINDS)
def test_lint_names_and_skips_hostile_files(project: Path, kind: str) -> None:
    """A hostile ledger, .options file and .proto file are each named with the reason; the rest is still checked."""
    names = ["mapping.lock", "proto/probe.options"] + (["proto/planted.proto"] if kind != "folder" else [])
    for name in names:
        fault = _plant(project / name, kind)
    (project / "proto" / "wrong.proto").write_text(_WRONG)
    done = _run(project, "lint")
    lines = done.stdout.splitlines()
    assert done.returncode == 2
    assert [name for name in names if any(f"{name}: " in line and fault in line for line in lines)] == names
    assert '"Missing" is not defined' in done.stdout


@_BOTH
@_SOME_KINDS
def test_a_hostile_table(project: Path, kind: str, command: tuple[str, ...]) -> None:
    """A table that is no file of the repository is named with the reason, and not read."""
    fault = _plant(project / "mapping.yaml", kind)
    _expect(_run(project, *command), 2, f"mapping.yaml: fatal[MAP101] the table cannot be read: {fault}")


@_SOME_KINDS
def test_check_compares_no_hostile_file(project: Path, kind: str) -> None:
    """A generated file that became hostile is named; its content does not appear in the differences."""
    planted = project / "generated" / "registry.py"
    fault = _plant(planted, kind)
    code, said = 2, f"generated/registry.py: fatal[OUT101] cannot read the file: {fault}"
    if planted.is_symlink():
        code, said = 1, "generated/registry.py: error[OUT109] cannot write 'generated/registry.py': a symbolic link"
    _expect(_run(project, *_CHECK), code, said)


def _import(project: Path, name: str) -> None:
    (project / "proto" / "probe.proto").write_text(PROBE_PROTO.replace("\n\n", f'\n\nimport "{name}";\n', 1))


@_SOME_KINDS
def test_no_hostile_file_is_imported(project: Path, kind: str) -> None:
    """Protoc does not read what an import names, if it is no file of the repository; the import is an error."""
    _plant(project / "proto" / "planted", kind)
    _import(project, "planted")
    for command in (_LINT, _CHECK):
        _expect(_run(project, *command), 1, 'proto/probe.proto:3:1: error[PRO101] Import "planted" was not found')


@pytest.mark.parametrize("imported", ["../../secret", "/etc/passwd", "./probe.proto", "../proto/probe.proto"])
def test_imports_stay_below_the_proto_root(project: Path, imported: str) -> None:
    """An import with an absolute path or dots is protoc's error, and no file is written anywhere."""
    before = sorted(project.parent.rglob("*"))
    _import(project, imported)
    _expect(_run(project, "lint"), 1, "error[PRO101]", start="proto/probe.proto")
    assert sorted(project.parent.rglob("*")) == before


@pytest.mark.parametrize("root", ["../elsewhere", "proto/link", "/"])
@_BOTH
def test_the_proto_root_is_in_the_repository(project: Path, root: str, command: tuple[str, ...]) -> None:
    """A `root` outside the repository, be it through a link, is one message at the key; nothing of it is read."""
    (project / "proto" / "link").symlink_to(project.parent / "elsewhere")
    (project / "mapping.yaml").write_text(_TABLE.replace("root: proto", f"root: {root}"))
    done = _run(project, *command)
    assert done.returncode in (1, 2)
    assert "mapping.yaml:2:15: " in done.stdout + done.stderr
    assert f"{root!r} is outside the git repository" in done.stdout + done.stderr


def test_links_to_folders(project: Path) -> None:
    """Links to a file and to a folder of the same repository are followed; a link out of it is named."""
    (project / "shared").mkdir()
    (project / "proto" / "probe.proto").rename(project / "shared" / "probe.proto")
    (project / "shared" / "wind.proto").write_text(_WRONG)
    (project / "proto" / "probe.proto").symlink_to("../shared/probe.proto")
    (project / "proto" / "weather").symlink_to("../shared")
    (project / "mapping.yaml").write_text(_TABLE.replace("root: proto", "root: proto, exclude: [weather/probe.proto]"))
    done = _run(project, "lint")
    assert (done.returncode, done.stdout.count("error[")) == (1, 1)
    assert 'proto/weather/wind.proto:4:3: error[PRO101] "Missing" is not defined' in done.stdout
    (project / "proto" / "weather").unlink()
    (project / "proto" / "weather").symlink_to("../../elsewhere")
    _expect(_run(project, "lint"), 2, f"proto/weather: fatal[PRO102] the folder was not read: {_OUT}")


def test_folders_that_multiply_through_links(project: Path) -> None:
    """17 folders with two links each make 260,000 paths; the walk ends before, and says so."""
    for level in range(17):
        here = project / "proto" / f"level{level}"
        here.mkdir()
        for name in ("left", "right"):
            (here / name).symlink_to(f"../level{level + 1}")
    (project / "proto" / "level17").mkdir()
    _expect(_run(project, "lint"), 2, "fatal[PRO102] the folder has more than 100000 entries")


def _commit_huge(project: Path, *names: str) -> None:
    """Commit files of 50 MB, and then their removal."""
    for name in names:
        with (project / name).open("wb") as file:
            file.truncate(50_000_000)
    subprocess.run(["git", "-c", "core.bigFileThreshold=1m", "add", "."], cwd=project, check=True)
    subprocess.run([*_COMMIT, "--all"], cwd=project, check=True)
    for name in names:
        (project / name).unlink()
    subprocess.run([*_COMMIT, "--all"], cwd=project, check=True)


_NOT_COMPARED = "hint[STA102] changes of these files were not compared, because the earlier state cannot be read there:"


def test_huge_files_in_an_earlier_state(project: Path) -> None:
    """Files of 50 MB in the state of `--against` are named in a hint and skipped; the rest is still compared."""
    names = ["mapping.lock", "proto/huge.proto", "proto/probe.options"]
    ledger = (project / "mapping.lock").read_text()
    _commit_huge(project, *names)
    (project / "mapping.lock").write_text(ledger)
    (project / "proto" / "probe.proto").write_text(PROBE_PROTO.replace("float", "double"))
    done = _run(project, "lint", "--against", "HEAD~1")
    assert done.returncode == 1
    not_compared = ", ".join(f"HEAD~1:{name}" for name in names)
    assert f"{_NOT_COMPARED} {not_compared}" in done.stdout
    assert "HEAD~1:proto/probe.proto:4:3" in done.stdout


def test_an_earlier_state_with_paths_out_of_its_folder(project: Path) -> None:
    """A tree in git can have an entry `..`, which git never checks out: its files are named and written nowhere."""

    def stored(kind: str, data: bytes) -> bytes:
        command = ["git", "hash-object", "-t", kind, "-w", "--literally", "--stdin"]
        said = subprocess.run(command, cwd=project, input=data, capture_output=True, check=True).stdout
        return bytes.fromhex(said.decode())

    file = stored("blob", PROBE_PROTO.encode())
    inner = stored("tree", b"100644 planted.proto\0" + file)
    tree = stored("tree", b"40000 ..\0" + inner + b"100644 probe.proto\0" + file)
    command = ["git", "-c", "user.name=A", "-c", "user.email=a@example.com", "commit-tree", "-m", "Add", tree.hex()]
    commit = subprocess.run(command, cwd=project, capture_output=True, check=True, text=True).stdout.strip()
    done = _run(project, "lint", "--against", commit)
    assert done.returncode == 0
    assert f"{_NOT_COMPARED} {commit}:../planted.proto" in done.stdout
    assert not (Path(tempfile.gettempdir()) / "planted.proto").exists()


# --- templates of the project's own ---


@pytest.fixture
def templates(project: Path) -> Path:
    """A folder of templates that the project's table names, with one template."""
    (project / "mapping.yaml").write_text(_TABLE + "templates: [own]\n")
    (project / "own").mkdir()
    (project / "own" / "all.txt.j2").write_text("{% include 'part' %}\n")
    return project / "own"


@pytest.mark.parametrize(
    ("name", "place", "of_link"),
    [
        ("planted.j2", "own/planted.j2: error[OUT107] ", "the link does not lead to a visible file inside the folder"),
        ("part", "own/all.txt.j2:1: error[OUT106] ", "'part' is not a visible file inside the folder of the templates"),
    ],
)
@_SOME_KINDS
def test_hostile_templates(project: Path, templates: Path, kind: str, name: str, place: str, of_link: str) -> None:
    """A template that must not be read, and one that a template includes, is named with the reason."""
    fault = _plant(templates / name, kind)
    _expect(_run(project, *_CHECK), 1, of_link if (templates / name).is_symlink() else fault, start=place)


# --- starting a project ---


@_SOME_KINDS
def test_adoption_of_hostile_files(project: Path, kind: str) -> None:
    """A hostile .proto file is named and no table is written; a hostile .options file is named and left out."""
    for name in ("mapping.yaml", "mapping.lock"):
        (project / name).unlink()
    fault = _plant(project / "proto" / "planted.proto", kind)
    said = f"proto/planted.proto: fatal[PRO102] the file cannot be read: {fault}"
    _expect(_run(project, "init", "--from", "proto"), 2, said)
    assert not (project / "mapping.yaml").exists()
    (project / "proto" / "planted.proto").unlink()
    fault = _plant(project / "proto" / "probe.options", kind)
    done = _run(project, "init", "--from", "proto")
    assert f"proto/probe.options: error[NPB101] the file cannot be read: {fault}" in done.stdout


# --- nothing is run ---

_MARK = "import os\nopen(os.environ['MARK'], 'w').close()\n"


def test_no_module_of_the_pull_request_is_imported(project: Path) -> None:
    """Modules with the names of libraries, Python's own start files and the generated package are not imported."""
    for name in ("google", "jinja2", "black", "grpc_tools", "roverlink", "yaml"):
        (project / name).mkdir()
        (project / name / "__init__.py").write_text(_MARK)
    for name in ("sitecustomize.py", "usercustomize.py", "json.py", "re.py", "pickle.py", "conftest.py"):
        (project / name).write_text(_MARK)
    (project / "generated" / "__init__.py").write_text(_MARK)
    for root in ("own", "proto"):
        (project / root / "jinja2").mkdir(parents=True)
        (project / root / "jinja2" / "__init__.py").write_text(_MARK)
    (project / "own" / "text.j2").write_text("{{ bridge.package }}\n")
    (project / "mapping.yaml").write_text(_TABLE + "templates: [own]\n")
    assert _run_alone(project, "generate", "--check").returncode == 1
    assert _run_alone(project, "lint").returncode == 0


def test_no_target_of_the_pull_request_is_loaded(project: Path) -> None:
    """Only an installed package can add a target, not one that lies in the current folder."""
    (project / "evil.py").write_text(_MARK)
    (project / "evil-1.0.dist-info").mkdir()
    (project / "evil-1.0.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: evil\nVersion: 1.0\n")
    (project / "evil-1.0.dist-info" / "entry_points.txt").write_text("[roverlink.targets]\nevil = evil:emit\n")
    (project / "mapping.yaml").write_text(_TABLE.replace("[python, nanopb]", "[python, evil]"))
    _expect(_run_alone(project, *_CHECK), 1, "'evil'")


@pytest.mark.parametrize(
    "arguments", [("lint",), ("lint", "proto"), ("lint", "--history"), ("lint", "--against", "main"), _CHECK]
)
def test_no_program_of_an_embedded_repository_is_run(project: Path, arguments: tuple[str, ...]) -> None:
    """Files that look like a bare repository are not one: the programs that their config names are not run."""
    proto = project / "proto"
    mark = f"touch '{project / 'MARK'}'"
    subprocess.run(["git", "init", "--quiet", "--bare", "--initial-branch", "main", str(proto)], check=True)
    git = ["git", "--git-dir", str(proto), "--work-tree", str(proto)]
    subprocess.run([*git, "add", "probe.proto"], check=True)
    subprocess.run([*git, *_COMMIT[1:]], check=True)
    (proto / ".gitattributes").write_text("* filter=evil diff=evil\n")
    (proto / "config").write_text(
        "[core]\n\trepositoryformatversion = 0\n\tbare = false\n\tworktree = .\n"
        f'\tfsmonitor = "{mark}"\n\tpager = "{mark}"\n\tsshCommand = "{mark}"\n\thooksPath = hooks\n'
        f'[filter "evil"]\n\tclean = "{mark}; cat"\n\tsmudge = "{mark}; cat"\n'
        f'[diff]\n\texternal = "{mark}"\n[diff "evil"]\n\ttextconv = "{mark}; cat"\n\tcommand = "{mark}"\n'
        f'[log]\n\tshowSignature = true\n[gpg]\n\tprogram = "{mark}"\n'
    )
    (proto / "probe.proto").write_text(PROBE_PROTO.replace("1;", "1 [deprecated = ];"))
    assert _run(project, *arguments).returncode in (1, 2)


# --- a misspelt key ---


@pytest.mark.parametrize(("key", "place", "typo"), [("proto:", "2:1", "porto:"), ("root:", "2:9", "rot:")])
def test_a_misspelt_key_does_not_widen_the_search(project: Path, key: str, place: str, typo: str) -> None:
    """Without `proto.root`, no folder is searched: the first message names the key, and none names a file below."""
    (project / "wrong.proto").write_text("this would be an error")
    os.mkfifo(project / "pipe.proto")
    (project / "mapping.yaml").write_text(_TABLE.replace(key, typo, 1))
    for command in (_LINT, _CHECK):
        done = _run(project, *command)
        said = done.stdout + done.stderr
        assert said.startswith(f"mapping.yaml:{place}: error[MAP104] unknown key {typo[:-1]!r}")
        assert f"help: did you mean {key[:-1]!r}?" in said
        assert ".proto" not in said.replace("envelope.proto", "")
        assert done.returncode == (2 if command == _LINT else 1)
