"""What all commands have in common: help, exit codes, and how they complain."""

from __future__ import annotations

import logging
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from roverlink.__main__ import main
from roverlink.command_line import COMMANDS, command_line
from roverlink.console import NoProjectError, node_logger, project_folder

_SUBCOMMANDS = [
    "aruco track",
    "aruco calibrate",
    "aruco board",
    "rocks measure",
    *(f"objects {name}" for name in ("track", "select", "train", "measure", "render")),
]

_ROOT = Path(__file__).parents[2]

Start = Callable[..., Any]


def _exits(*arguments: str) -> int:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    code = caught.value.code
    assert isinstance(code, int)
    return code


@pytest.mark.parametrize("command", [*COMMANDS, *_SUBCOMMANDS])
def test_every_help_has_an_example(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    """`--help` says what the command does, and shows one way to call it."""
    assert _exits(*command.split(), "--help") == 0
    text = capsys.readouterr().out
    assert f"usage: roverlink {command}" in text
    assert f"\nexample: roverlink {command}" in text


def test_the_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    """Without a command, the help lists all of them."""
    assert _exits("--help") == 0
    text = capsys.readouterr().out
    assert "example: " in text
    assert re.findall(r"^    (\S+)", text, re.MULTILINE) == list(COMMANDS)


def test_the_version_is_the_package_s(capsys: pytest.CaptureFixture[str]) -> None:
    """`roverlink --version` prints the version that pyproject.toml gives, for reports of faults."""
    assert _exits("--version") == 0
    declared = re.search(r'^version = "(.+)"$', (_ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)
    assert declared
    assert capsys.readouterr().out == f"roverlink {declared[1]}\n"


def test_the_example_of_each_help_is_understood(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a help shows is a line that the command takes."""
    import shlex

    from roverlink.runtime.ros_arguments import ros_args

    monkeypatch.chdir(_ROOT / "generated" / "ros" / "comms" / "config")  # where udp.yaml is
    for command in (*COMMANDS, *_SUBCOMMANDS):
        _exits(*command.split(), "--help")
        examples = capsys.readouterr().out.rpartition("example: roverlink ")[2].split("\n         roverlink ")
        for example in examples:
            own, ros = ros_args.split(shlex.split(example))
            assert command_line(own).parse_args(own).run
            ros_args.parse(ros, "udp_forwarder")


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], "required: command"),
        (["frobnicate"], "unknown command 'frobnicate'; known: init, generate"),
        (["lnit"], "unknown command 'lnit'; did you mean 'lint'?"),
        (["aruco", "bord"], "unknown command 'bord'; did you mean 'board'?"),
        (["--verison"], "unknown option '--verison'; did you mean '--version'?"),
        (["lint", "--agianst", "main"], "unknown option '--agianst'; did you mean '--against'?"),
        (["export", "--topc=imu_data"], "unknown option '--topc'; did you mean '--topic'?"),
        (["run", "--middleware", "ddss"], "unknown value 'ddss'; did you mean 'dds'?"),
        (["run", "--frobnicate"], "unknown option '--frobnicate'; did you mean '--rotate'?"),
        (["run", "--zzz"], "unknown option '--zzz'; known: --help, --record, --project, --middleware"),
        (["run", "--middleware", "zenoh"], "unknown value 'zenoh'; known: auto, dds, rclpy, memory"),
        (["listen"], "required: --port"),
        (["listen", "--port", "x"], "'x' is not a port number from 0 to 65535"),
        (["listen", "--port", "65536"], "'65536' is not a port number from 0 to 65535"),
        (["listen", "--port", "-1"], "'-1' is not a port number from 0 to 65535"),
        (["listen", "--port", "1", "--count", "0"], "'0' is not a whole number above 0"),
        (["send", "imu_info", "--count", "-1"], "'-1' is not a whole number above 0"),
        (["send", "imu_info", "--count", "1.5"], "'1.5' is not a whole number above 0"),
        (["send", "imu_info", "--rate", "0"], "'0' is not a frequency above 0"),
        (["send", "imu_info", "--rate", "nan"], "'nan' is not a frequency above 0"),
        (["send", "imu_info", "--rate", "inf"], "'inf' is not a frequency above 0"),
        (["send", "imu_info", "--rate", "1e-300"], "'1e-300' is not a frequency above 0"),
        (["echo", "a", "--timeout", "1e300"], "'1e300' is not a duration in seconds"),
        (["aruco", "track", "0", "--side", "1e200"], "'1e200' is not METRES or ID=METRES"),
        (["aruco", "track", "0", "--side", "=1"], "'=1' is not METRES or ID=METRES"),
        (["aruco", "board", "--square", "1e-300"], "'1e-300' is not a length in metres"),
        (["echo"], "required: topic"),
        (["echo", "a", "b"], "unrecognized arguments: b"),
        (["echo", "a", "--timeout", "-1"], "'-1' is not a duration in seconds"),
        (["echo", "a", "--count", "many"], "'many' is not a whole number above 0"),
        (["pub"], "required: topic"),
        (["pub", "a", "{}", "b"], "unrecognized arguments: b"),
        (["pub", "a", "--rate=-1"], "'-1' is not a frequency above 0"),
        (["pub", "a", "--wait", "nan"], "'nan' is not a duration in seconds"),
        (["demo", "--seconds", "soon"], "'soon' is not a duration in seconds"),
        (["demo", "--middleware", "auto"], "unknown value 'auto'; known: dds, rclpy, memory"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_line_that_is_not_understood_is_told(
    arguments: list[str], expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit code 2, one line that says what is wrong with which argument, and the command that shows the usage."""
    assert _exits(*arguments) == 2
    output, errors = capsys.readouterr()
    assert output == ""
    assert errors.startswith("roverlink")
    assert expected in errors.splitlines()[0]
    assert re.fullmatch(r"run `roverlink.* --help` for all arguments", "\n".join(errors.splitlines()[1:]))


def test_an_option_may_be_shortened_and_what_follows_two_dashes_is_a_value() -> None:
    """Only options that no command knows are refused: not their beginnings, and not values."""
    arguments = ["pub", "--cou", "2", "imu_data", "--", "--x"]
    options = command_line(arguments).parse_args(arguments)
    assert (options.count, options.topic, options.values) == (2, "imu_data", "--x")


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("roverlink re", {"retire", "record", "replay"}),
        ("roverlink lint --ag", {"--against"}),
        ("roverlink lint --format ", {"text", "json", "github", "sarif", "junit"}),
        ("roverlink aruco bo", {"board"}),
        ("roverlink frobnicate --x", set()),
    ],
)
@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_shells_complete_commands_options_and_choices(
    shell: str, line: str, expected: set[str], tmp_path: Path, environment: dict[str, str]
) -> None:
    """The shells' completion, which sets these variables, gets the words that fit the line so far."""
    answer = tmp_path / "answer"
    asked = {"COMP_LINE": line, "COMP_POINT": str(len(line)), "_ARGCOMPLETE": "1", "_ARGCOMPLETE_SHELL": shell}
    output = {"_ARGCOMPLETE_STDOUT_FILENAME": str(answer), "_ARGCOMPLETE_IFS": "\n", "_ARGCOMPLETE_SUPPRESS_SPACE": "1"}
    command = [sys.executable, "-m", "roverlink"]
    done = subprocess.run(command, env={**environment, **asked, **output}, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    words = re.split(r"\n", answer.read_text()) if answer.exists() else []
    assert "None" not in "".join(words)
    assert {re.split(r"[:\t]", word)[0].strip() for word in words} - {""} == expected


@pytest.fixture
def in_shell(tmp_path: Path, environment: dict[str, str]) -> Callable[[str, str], list[str]]:
    """Runs a script in a shell that finds `roverlink` and argcomplete's program; returns the words that it prints."""
    for name, module in (
        ("roverlink", "roverlink"),
        ("register-python-argcomplete", "argcomplete.scripts.register_python_argcomplete"),
    ):
        (tmp_path / name).write_text(f'#!/bin/sh\nexec {sys.executable} -m {module} "$@"\n')
        (tmp_path / name).chmod(0o755)

    def in_shell(shell: str, script: str) -> list[str]:
        if not shutil.which(shell):
            pytest.skip(f"{shell} is not installed")
        path = {"PATH": f"{tmp_path}:{environment['PATH']}", "HOME": str(tmp_path)}
        done = subprocess.run([shell, "-c", script], env={**environment, **path}, capture_output=True, text=True)
        assert done.stderr == ""
        return done.stdout.split()

    return in_shell


def test_fish_completes_after_the_line_of_the_readme(in_shell: Callable[[str, str], list[str]]) -> None:
    """In a real fish, the registration makes the tab key complete a command."""
    registered = "register-python-argcomplete --shell fish roverlink | source"
    assert in_shell("fish", f"{registered}; complete --do-complete 'roverlink gene'") == ["generate"]


def test_bash_completes_after_the_line_of_the_readme(in_shell: Callable[[str, str], list[str]]) -> None:
    """In a real bash, the registration makes the tab key complete a command."""
    script = """
        eval "$(register-python-argcomplete roverlink)"
        COMP_LINE='roverlink gene' COMP_POINT=14 COMP_TYPE=9 COMP_KEY=9 COMP_WORDS=(roverlink gene) COMP_CWORD=1
        "$(complete -p roverlink | sed 's/.*-F \\([^ ]*\\).*/\\1/')" roverlink gene roverlink
        echo "${COMPREPLY[@]}"
    """
    assert in_shell("bash", script) == ["generate"]


def test_the_version_and_an_unknown_command_import_no_command(environment: dict[str, str]) -> None:
    """Both end without the commands, the generator and the bridge, whose imports take most of a start."""
    for arguments in (["--version"], ["--hlp"]):
        script = f"""
import sys
from roverlink.__main__ import main
try:
    main({arguments})
finally:
    slow = ("roverlink.commands", "roverlink.generator", "roverlink.runtime.bridge", "yaml", "rich")
    print([name for name in sys.modules if name.startswith(slow)], file=sys.stderr)
"""
        done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True)
        assert "\n[]\n" in f"\n{done.stderr}", arguments


@pytest.mark.parametrize("command", ["send", "listen", "echo", "pub", "run", "demo"])
def test_a_project_without_generated_code_is_told(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each command that needs generated code says where there is none, with exit code 2."""
    monkeypatch.setenv("ROS_DOMAIN_ID", "1")  # which the demo sets for itself
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    more = {"send": ["imu_info"], "listen": ["--port", "0"], "echo": ["a"], "pub": ["a"]}.get(command, [])
    assert main([command, *more, "--project", str(tmp_path)]) == 2
    assert f"roverlink: no generated code in {tmp_path}" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["run", "record", "replay", "send", "listen", "echo", "pub", "simulate", "demo"])
def test_outside_of_a_project_the_way_to_start_one_is_told(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each command that needs a project ends with exit code 2 where there is none, and names `roverlink init`."""
    monkeypatch.setenv("ROS_DOMAIN_ID", "1")  # which the demo sets for itself
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    monkeypatch.chdir(tmp_path)
    more = {
        "record": ["a.mcap"],
        "replay": ["a.mcap"],
        "send": ["imu_info"],
        "listen": ["--port", "0"],
        "echo": ["a"],
        "pub": ["a"],
    }
    assert main([command, *more.get(command, [])]) == 2
    errors = capsys.readouterr().err
    assert f"roverlink: no mapping.yaml in {tmp_path} or a folder above it" in errors
    assert "`roverlink init`" in errors


def test_commands_work_from_any_folder_of_a_project(done: Start) -> None:
    """The project is found from a folder below it."""
    code, output, _ = done("send", "--list", folder=_ROOT / "proto" / "components")
    assert code == 0
    assert "imu_info" in output


# --- what they share --------------------------------------------------------------------------------------------


def test_the_project_is_the_nearest_folder_that_is_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with a table or with generated code is a project; what was given goes before it."""
    inner = tmp_path / "outer" / "inner" / "deep"
    inner.mkdir(parents=True)
    monkeypatch.chdir(inner)
    with pytest.raises(NoProjectError, match=r"roverlink init"):
        project_folder(None)
    (tmp_path / "outer" / "mapping.yaml").touch()
    assert project_folder(None) == tmp_path / "outer"
    (inner.parent / "generated").mkdir()
    (inner.parent / "generated" / "registry.py").touch()
    assert project_folder(None) == inner.parent
    assert project_folder(tmp_path) == tmp_path


@pytest.mark.parametrize(
    ("level", "shown"),
    [
        ("debug", ["DEBUG", "INFO", "WARN", "ERROR", "FATAL"]),
        ("info", ["INFO", "WARN", "ERROR", "FATAL"]),
        ("warn", ["WARN", "ERROR", "FATAL"]),
        ("error", ["ERROR", "FATAL"]),
        ("fatal", ["FATAL"]),
    ],
)
def test_the_logger_has_ros_2s_levels(level: str, shown: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """Each level shows itself and what is graver, once, by ROS 2's names."""
    for _ in range(2):  # a second logger of the same name does not double the lines
        logger = node_logger("test_levels", level)
    for number in (logging.DEBUG, logging.INFO, logging.WARNING, logging.ERROR, logging.CRITICAL):
        logger.log(number, "text")
    lines = capsys.readouterr().err.splitlines()
    assert [line.partition("]")[0].lstrip("[") for line in lines] == shown
    assert all(line.endswith("[test_levels]: text") for line in lines)
