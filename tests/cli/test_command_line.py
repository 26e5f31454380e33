"""What all commands have in common: help, exit codes, and how they complain."""

from __future__ import annotations

import logging
import os
import re
import shlex
import shutil
import subprocess
import sys
from importlib.metadata import metadata
from pathlib import Path

import pytest
from needs import needs_dds
from running import exit_code, record_one_message

from roverlink.__main__ import main
from roverlink.command_line import COMMANDS, ELSEWHERE, ENTRY_POINTS, GROUPS, command_line
from roverlink.commands.explain import all_rules
from roverlink.console import NoProjectError, node_logger, project_folder
from roverlink.installed_packages import entry_points
from roverlink.runtime.ros_arguments import ros_args

_SUBCOMMANDS = [
    "aruco track",
    "aruco calibrate",
    "aruco board",
    "rocks measure",
    *(f"objects {name}" for name in ("track", "select", "train", "measure", "render")),
]

_ROOT = Path(__file__).parents[2]
_OWN = [name for names in GROUPS.values() for name in names]


@pytest.mark.parametrize("command", [*COMMANDS, *_SUBCOMMANDS])
def test_every_help_has_an_example(
    command: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """`--help` says what the command does, and shows one way to call it, which the command takes."""
    monkeypatch.chdir(_ROOT / "generated" / "ros" / "comms" / "config")  # where udp.yaml is
    assert exit_code(*command.split(), "--help") == 0
    text = capsys.readouterr().out
    assert f"usage: roverlink {command}" in text
    before, _, examples = text.rpartition(f"\nexample: roverlink {command}")
    assert before
    for example in f"{command}{examples}".split("\n         roverlink "):
        own, ros = ros_args.split(shlex.split(example))
        assert command_line(own).parse_args(own).run
        ros_args.parse(ros, "udp_forwarder")


def test_the_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    """The help lists all commands by their job; so does `roverlink` or a group alone, which is not a success."""
    assert exit_code("--help") == 0
    text = capsys.readouterr().out
    assert "example: " in text
    listed = re.findall(r"^  ([a-z]\S+) ", text, re.MULTILINE)
    assert sorted(listed) == sorted(COMMANDS)
    assert listed[: len(_OWN)] == _OWN
    assert (exit_code(), capsys.readouterr().out) == (2, text)
    assert (exit_code("number", "--help"), exit_code("number")) == (0, 2)
    text = capsys.readouterr().out
    assert text == 2 * text[: len(text) // 2]


def test_a_command_of_a_package_that_is_not_installed_is_named(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """`roverlink aruco` without roverkit says how to install roverkit; the help lists roverlink's own commands."""
    monkeypatch.setattr("importlib.metadata.entry_points", lambda **_: ())
    assert exit_code("aruco", "track", "0") == 2
    assert (
        "'aruco' is a command of roverkit; install it in roverlink's repository with `pip install './rover[vision]'`"
        in capsys.readouterr().err
    )
    assert exit_code("--help") == 0
    assert re.findall(r"^  ([a-z]\S+) ", capsys.readouterr().out, re.MULTILINE) == _OWN


def test_the_packages_add_the_commands_that_roverlink_names() -> None:
    """What roverlink says about commands of other packages is what these packages declare."""
    for package, commands in ELSEWHERE.items():
        assert {one.name for one in entry_points(ENTRY_POINTS) if one.dist.name == package} == set(commands)
        assert {*commands.values(), ""} <= {*metadata(package).get_all("Provides-Extra", []), ""}


def test_the_version_is_the_package_s(capsys: pytest.CaptureFixture[str]) -> None:
    """`roverlink --version` prints the version that pyproject.toml gives, for reports of faults."""
    assert exit_code("--version") == 0
    declared = re.search(r'^version = "(.+)"$', (_ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)
    assert declared
    assert capsys.readouterr().out == f"roverlink {declared[1]}\n"


def test_an_option_may_be_shortened_and_what_follows_two_dashes_is_a_value() -> None:
    """Only options that no command knows are refused: not their beginnings, and not values."""
    arguments = ["pub", "--cou", "2", "imu_data", "--", "--x"]
    options = command_line(arguments).parse_args(arguments)
    assert (options.count, options.topic, options.values) == (2, "imu_data", "--x")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shell", "line", "expected"),
    [
        ("bash", "roverlink re", {"record", "recording"}),
        ("zsh", "roverlink lint --format ", {"text", "json", "github", "sarif", "junit"}),
        ("bash", "roverlink send imu_", {"imu_info"}),
        ("bash", "roverlink echo odometry/", {"odometry/global", "odometry/wheel"}),
        ("bash", "roverlink explain ENV10", {id for id in all_rules() if id.startswith("ENV10")}),
    ],
)
def test_shells_complete_what_was_begun(
    shell: str, line: str, expected: set[str], tmp_path: Path, environment: dict[str, str]
) -> None:
    """A shell that asks with these variables gets commands, choices, rows, the topics of nodes, and rules."""
    answer = tmp_path / "answer"
    asked = {"COMP_LINE": line, "COMP_POINT": str(len(line)), "_ARGCOMPLETE": "1", "_ARGCOMPLETE_SHELL": shell}
    output = {"_ARGCOMPLETE_STDOUT_FILENAME": str(answer), "_ARGCOMPLETE_IFS": "\n", "_ARGCOMPLETE_SUPPRESS_SPACE": "1"}
    command = [sys.executable, "-m", "roverlink"]
    given = {**environment, **asked, **output}
    done = subprocess.run(command, cwd=_ROOT, env=given, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    words = answer.read_text().split("\n") if answer.exists() else []
    assert "None" not in "".join(words)
    assert {re.split(r"[:\t]", word)[0].strip() for word in words} - {""} == expected


@pytest.mark.slow
def test_bash_completes_after_the_line_of_the_readme(tmp_path: Path, environment: dict[str, str]) -> None:
    """In a real shell, the registration makes the tab key complete a command."""
    script = """
        eval "$(register-python-argcomplete roverlink)"
        COMP_LINE='roverlink gene' COMP_POINT=14 COMP_TYPE=9 COMP_KEY=9 COMP_WORDS=(roverlink gene) COMP_CWORD=1
        "$(complete -p roverlink | sed 's/.*-F \\([^ ]*\\).*/\\1/')" roverlink gene roverlink
        echo "${COMPREPLY[@]}"
    """
    for name, module in (
        ("roverlink", "roverlink"),
        ("register-python-argcomplete", "argcomplete.scripts.register_python_argcomplete"),
    ):
        (tmp_path / name).write_text(f'#!/bin/sh\nexec {sys.executable} -m {module} "$@"\n')
        (tmp_path / name).chmod(0o755)
    path = {"PATH": f"{tmp_path}:{environment['PATH']}", "HOME": str(tmp_path)}
    done = subprocess.run(["bash", "-c", script], env={**environment, **path}, capture_output=True, text=True)
    assert (done.stderr, done.stdout.split()) == ("", ["generate"])


_NO_COMMAND = """
import contextlib
from roverlink.__main__ import main
for word in ("--version", "--hlp"):
    with contextlib.suppress(SystemExit):
        main([word])
"""
_BRIDGE = """
from pathlib import Path
from roverlink.commands import run
from roverlink.generated_code import load_project
from roverlink.runtime.middleware import NodeIdentity, open_middleware
handlers = load_project(Path()).handlers
node = open_middleware("dds", NodeIdentity("start"))
for handler in handlers:
    node.publisher(f"/{handler.route.topic}", handler.message_type, handler.route.qos)
node.close()
"""


@pytest.mark.parametrize(
    ("script", "slow"),
    [
        (_NO_COMMAND, ("roverlink.commands", "roverlink.generator", "roverlink.runtime.bridge", "yaml", "rich")),
        pytest.param(
            _BRIDGE,
            ("roverlink.generator.table", "http", "asyncio", "cyclonedds.idl._xt", "cyclonedds.idl._typesupport.DDS.X"),
            marks=[needs_dds, pytest.mark.slow],
        ),
    ],
)
def test_a_start_imports_nothing_that_it_does_not_need(
    script: str, slow: tuple[str, ...], environment: dict[str, str]
) -> None:
    """Imports take most of a start. The first bridge also compiles the DDS types, which then stay in the cache."""
    ending = f"import sys\nprint([name for name in sys.modules if name.startswith({slow})])"
    for _ in range(2):
        command = [sys.executable, "-c", script + ending]
        done = subprocess.run(command, cwd=_ROOT, env=environment, capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "[]", done.stderr


@pytest.mark.parametrize(
    "line", ["run", "recording replay a.mcap", "send imu_info", "listen --port 0", "simulate", "demo"]
)
def test_outside_of_a_project_the_way_to_start_one_is_told(
    line: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each command that needs a project ends with exit code 2 where there is none, and names `roverlink init`."""
    monkeypatch.chdir(tmp_path)
    assert main(line.split()) == 2
    errors = capsys.readouterr().err
    assert f"roverlink: no mapping.yaml in {tmp_path} or a folder above it" in errors
    assert "`roverlink init`" in errors


_HIDING = """
import sys
sys.modules.update(dict.fromkeys(sys.argv[1].split(",")))
from roverlink.__main__ import main
"""
"""Start of a script in which the packages of the first argument cannot be imported."""


@pytest.mark.slow
def test_help_needs_no_other_package(environment: dict[str, str]) -> None:
    """With protobuf and PyYAML alone, every command of roverlink explains itself."""
    script = f"""{_HIDING}
from roverlink import command_line
for line in ([name] for names in command_line.GROUPS.values() for name in names):
    try:
        main([*line, "--help"])
    except SystemExit as end:
        assert not end.code, line
"""
    others = (
        "argcomplete,black,cyclonedds,foxglove,grpc_tools,jinja2,mcap,nanopb,prometheus_client,pyarrow,rich,rosbags"
    )
    done = subprocess.run([sys.executable, "-c", script, others], env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "line", "install"),
    [
        ("black", "init", "'black<27,>=26.1'"),
        ("google", "lint", "'protobuf<8,>=3.20'"),
        ("grpc_tools", "lint", "'grpcio-tools==1.85.1'"),
        ("jinja2", "init", "'jinja2>=3.1.6'"),
        ("mcap", "recording info {run}", "'SOURCE[record]'"),
        ("lz4", "recording info {run}", "'SOURCE[record]'"),
        ("prometheus_client", "run --middleware memory --metrics 0 --ros-args -p listen_port:=0", "'SOURCE[metrics]'"),
        ("pyarrow", "recording export {run} --topic imu_data --to parquet", "'SOURCE[parquet]'"),
        ("rosbags", "echo spoken --type std_msgs/msg/String", "'SOURCE[standard]'"),
        ("yaml", "lint", "'pyyaml>=6'"),
        ("cyclonedds", "simulate --bridge dds --seconds 1", "cyclonedds"),
    ],
)
def test_a_missing_package_is_named(
    module: str, line: str, install: str, environment: dict[str, str], tmp_path: Path
) -> None:
    """One line says how to install it, exit code 2; no other middleware takes its place."""
    run = record_one_message(tmp_path / "run.mcap") if "{run}" in line else None
    environment["XDG_CACHE_HOME"] = str(tmp_path / "cache")  # what black has formatted before needs no black
    command = [sys.executable, "-c", f"{_HIDING}sys.exit(main(sys.argv[2:]))", module, *line.format(run=run).split()]
    (tmp_path / "empty").mkdir()
    folder = tmp_path / "empty" if line == "init" else _ROOT
    done = subprocess.run(command, env=environment, cwd=folder, capture_output=True, text=True)
    assert (done.returncode, done.stdout, len(done.stderr.splitlines())) == (2, "", 1)
    assert f"`pip install {install}`" in done.stderr


def test_a_clone_without_symbolic_links_is_told(tmp_path: Path, environment: dict[str, str]) -> None:
    """On Windows, git may write the link's target into a file of its name; one line says how to get links."""
    for path in (_ROOT / "roverlink").iterdir():
        if path.is_symlink():
            (tmp_path / "roverlink" / path.name).write_text(os.readlink(path))
        elif path.suffix == ".py":
            (tmp_path / "roverlink").mkdir(exist_ok=True)
            (tmp_path / "roverlink" / path.name).write_bytes(path.read_bytes())
    shutil.copytree(_ROOT / "roverlink" / "commands", tmp_path / "roverlink" / "commands")
    command = [sys.executable, "-m", "roverlink", "lint"]
    done = subprocess.run(command, env={**environment, "PYTHONPATH": ""}, cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1)
    assert "run `git config core.symlinks true` and `git checkout .` in the clone" in done.stderr


def test_the_project_is_the_nearest_folder_that_is_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with a table or with generated code is a project; what was given goes before it.

    Far from all of them, it is the code in the first sourced ROS 2 package that has installed some.
    """
    inner = tmp_path / "outer" / "inner" / "deep"
    inner.mkdir(parents=True)
    monkeypatch.chdir(inner)
    with pytest.raises(NoProjectError, match=r"roverlink init"):
        project_folder(None)
    sourced = [tmp_path / name for name in ("nav2", "overlay", "ros")]
    for prefix in sourced[1:]:
        code = prefix / "lib" / "comms" / "project" / "rover" / "code"
        code.mkdir(parents=True)
        (code / "registry.py").touch()
    monkeypatch.setenv("AMENT_PREFIX_PATH", os.pathsep.join(map(str, sourced)))
    assert project_folder(None) == tmp_path / "overlay" / "lib" / "comms" / "project"
    (tmp_path / "outer" / "mapping.yaml").touch()
    assert project_folder(None) == tmp_path / "outer"
    (inner.parent / "generated").mkdir()
    (inner.parent / "generated" / "registry.py").touch()
    assert project_folder(None) == inner.parent
    assert project_folder(tmp_path) == tmp_path


@pytest.mark.parametrize("first", range(5))
def test_the_logger_has_ros_2s_levels(first: int, capsys: pytest.CaptureFixture[str]) -> None:
    """Each level shows itself and what is graver, once, by ROS 2's names."""
    names = ["DEBUG", "INFO", "WARN", "ERROR", "FATAL"]
    loggers = [node_logger("test_levels", level) for level in (names[first].lower(), "fatal")]
    logger = loggers[0]  # a second logger of the same name neither doubles the lines nor changes the level
    for number in (logging.DEBUG, logging.INFO, logging.WARNING, logging.ERROR, logging.CRITICAL):
        logger.log(number, "text")
    lines = capsys.readouterr().err.splitlines()
    assert [line.partition("]")[0].lstrip("[") for line in lines] == names[first:]
    assert all(line.endswith("[test_levels]: text") for line in lines)
