"""What stands after `--ros-args`, as rcl reads it."""

from __future__ import annotations

import logging
import textwrap
from pathlib import Path
from typing import Any

import pytest

from generated.registry import REGISTRY
from roverlink.runtime import SetupError
from roverlink.runtime.ros_arguments import parameters, ros_args
from roverlink.runtime.ros_arguments.ros_args import RosArguments, parse, split
from roverlink.runtime.text.strict_yaml import load

_NODE = "udp_forwarder"
_GENERATED_FILE = Path(__file__).parents[2] / "generated" / "ros" / "comms" / "config" / "udp.yaml"


def _parsed(line: str, *more: str) -> RosArguments:
    return parse([*line.split(), *more], _NODE)


def _refused(*arguments: str) -> str:
    with pytest.raises(SetupError) as caught:
        parse(list(arguments), _NODE)
    return str(caught.value)


# --- which arguments are ROS's ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "own", "ros"),
    [
        ("", "", ""),
        ("run --ros-args -p a:=1 -- --json", "run --json", "-p a:=1"),
        ("run --ros-args -p a:=1 --ros-args -p b:=2 -- x", "run x", "-p a:=1 -p b:=2"),
        ("run --ros-args -p a:=1 -- x --ros-args -p b:=2", "run x", "-p a:=1 -p b:=2"),
        ("run --ros-args", "run", ""),
        ("run --ros-args -- -- x", "run -- x", ""),
    ],
)
def test_the_line_is_split(line: str, own: str, ros: str) -> None:
    """ROS's part runs from `--ros-args` to `--` or the end, any number of times; a `--` of our own stays."""
    assert split(line.split()) == (own.split(), ros.split())


# --- parameters -------------------------------------------------------------------------------------------------


def test_each_parameter_is_declared_once() -> None:
    """The strict reader, which takes too long for each start, reads the same declarations."""
    text = Path(parameters.__file__).with_name("node_parameters.yaml").read_text(encoding="utf-8")
    assert {name: parameters.Declaration(**said) for name, said in load(text).items()} == parameters.DECLARED


@pytest.mark.parametrize(
    ("text", "value"),
    [
        *[("5001", 5001), ("1.5", 1.5), ("true", True), ("'5001'", "5001"), ("10.0.0.7", "10.0.0.7")],
        *[('"a b"', "a b"), ("[1, 2]", [1, 2]), ("", None), ("a:=b", "a:=b")],
    ],
)
def test_a_parameter_has_the_type_that_yaml_gives_it(text: str, value: object) -> None:
    """`name:=value` is read as YAML, so that a number is a number and a quoted one a string."""
    assert parse(["-p", f"a:={text}", "--param", f"b:={text}"], _NODE).parameters == {"a": value, "b": value}


def test_a_parameter_may_name_its_node_and_the_last_one_counts() -> None:
    """A parameter of another node is left to it; one of this node, by its remapped name, is taken."""
    assert _parsed("-p udp_forwarder:a:=1 -p other:a:=2 -p b:=1 -p b:=3").parameters == {"a": 1, "b": 3}
    assert _parsed("-r __node:=other -p udp_forwarder:a:=1 -p other:a:=2").parameters == {"a": 2}


# --- parameter files --------------------------------------------------------------------------------------------


def _from_file(folder: Path, text: str, line: str = "") -> dict[str, Any]:
    path = folder / "params.yaml"
    path.write_text(textwrap.dedent(text), encoding="utf-8")
    return _parsed(line, "--params-file", str(path)).parameters


_SECTION = "{key}:\n  ros__parameters:\n    a: 1\n"


@pytest.mark.parametrize(
    ("key", "line", "applies"),
    [
        ("udp_forwarder", "", True),
        ("/**", "", True),
        ("'**'", "", True),
        ("/*", "", True),
        ("/udp_forwarde", "", False),
        ("/rover/udp_forwarder", "", False),
        ("udp_forwarder", "-r __ns:=/rover", False),
        ("/rover/udp_forwarder", "-r __ns:=/rover", True),
        ("/rover/*", "-r __ns:=/rover", True),
        ("/**", "-r __ns:=/rover/front", True),
        ("/**/udp_forwarder", "-r __ns:=/rover/front", True),
        ("/rover/*", "-r __ns:=/rover/front", False),
        ("other", "-r __node:=other", True),
        ("/rov.r/udp_forwarder", "-r __ns:=/rover", False),
    ],
)
def test_a_section_applies_by_name_full_name_or_wildcard(tmp_path: Path, key: str, line: str, applies: bool) -> None:
    """`*` stands for one name, `**` for any number; a plain name is that of a node in the root namespace."""
    assert _from_file(tmp_path, _SECTION.format(key=key), line) == ({"a": 1} if applies else {})


@pytest.mark.parametrize(
    ("key", "line", "ignored"),
    [
        ("/**", "", {"listen_prt": "WARNING", "robot_radius": "DEBUG", "robot": "DEBUG"}),
        ("/*", "-p robot:=1 -p udp_forwarder:listen_prt:=1", {"robot": "WARNING", "robot_radius": "DEBUG"}),
        ("/*", "-p udp_forwarder:robot:=1 -p listen_prt:=1", {"robot_radius": "DEBUG"}),
        ("udp_forwarder", "", {}),
        ("/**/udp_forwarder", "", {}),
    ],
)
def test_a_section_for_several_nodes_may_have_parameters_of_others(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, key: str, line: str, ignored: dict[str, str]
) -> None:
    """They are ignored and logged, as a warning if the name looks misspelt. So are those of SetParameter (`-p`)."""
    path = tmp_path / "params.yaml"
    path.write_text(f"{key}:\n  ros__parameters: {{listen_prt: 2, robot_radius: 0.3, robot: {{mass: 3}}}}\n")
    parsed, known = _parsed(line, "--params-file", str(path)), parameters.declarations(REGISTRY)
    with caplog.at_level("DEBUG"):
        assert parsed.parameters_in(known, logging.getLogger("x")).keys() == parsed.parameters.keys() - ignored
    assert {record.getMessage().split("'")[1]: record.levelname for record in caplog.records} == ignored


def test_namespaces_may_be_nested_mappings(tmp_path: Path) -> None:
    """A namespace may hold its nodes as a mapping, as rcl's own files have it."""
    text = """
        rover:
          front:
            udp_forwarder: {ros__parameters: {a: 1}}
          udp_forwarder: {ros__parameters: {a: 2}}
        """
    assert _from_file(tmp_path, text, "-r __ns:=/rover/front") == {"a": 1}
    assert _from_file(tmp_path, text, "-r __ns:=/rover") == {"a": 2}
    assert _from_file(tmp_path, text) == {}


def test_later_sections_files_and_parameters_count(tmp_path: Path) -> None:
    """Within a file, and along the line, what comes later replaces what came before."""
    text = """
        /**: {ros__parameters: {a: 1, b: 1, c: 1}}
        udp_forwarder: {ros__parameters: {b: 2, c: 2}}
        other: {ros__parameters: {c: 9}}
        """
    assert _from_file(tmp_path, text) == {"a": 1, "b": 2, "c": 2}
    path = str(tmp_path / "params.yaml")
    assert _parsed("-p b:=7", "--params-file", path).parameters["b"] == 2
    assert _parsed("", "--params-file", path, "-p", "b:=7").parameters["b"] == 7


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a: [1", ":1:6: not valid YAML"),
        ("a: 2024-13-45", ":1:4: 2024-13-45 is not a valid value"),
        ("udp_forwarder: {}\nudp_forwarder: {}", ":2:1: the key udp_forwarder occurs twice"),
        ("[" * 1100, "nested too deeply"),
        ("just a text", "expected node names"),
        ("", "expected node names"),
        ("udp_forwarder: 3", "udp_forwarder has no `ros__parameters:`"),
        ("udp_forwarder: {ros__parameters: 3}", "udp_forwarder has no `ros__parameters:`"),
        ("udp_forwarder: {listen_port: 3}", "/udp_forwarder/listen_port has no `ros__parameters:`"),
        ("\xff\xfe\x00", "cannot read the file"),
    ],
)
def test_a_file_of_another_form_is_told(tmp_path: Path, text: str, expected: str) -> None:
    """A file that is no text, no YAML, or has no nodes with parameters, is named with what it lacks."""
    path = tmp_path / "params.yaml"
    path.write_bytes(text.encode("latin-1"))
    message = _refused("--params-file", str(path))
    assert expected in message
    assert str(path) in message


# --- remaps -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "topic", "expected"),
    [
        ("-r imu_data:=imu/raw", "imu_data", "/imu/raw"),
        ("", "imu_data", "/imu_data"),
        ("-r imu_data:=/imu", "imu_data", "/imu"),
        ("-r imu_data:=~/imu", "imu_data", "/udp_forwarder/imu"),
        ("-r __ns:=/rover", "imu_data", "/rover/imu_data"),
        ("-r __ns:=/rover", "~/imu", "/rover/udp_forwarder/imu"),
        ("-r __ns:=/rover -r imu_data:=imu", "imu_data", "/rover/imu"),
        ("-r __ns:=/rover -r /imu_data:=imu", "imu_data", "/rover/imu_data"),
        ("-r __ns:=/rover -r /rover/imu_data:=/imu", "imu_data", "/imu"),
        ("-r __node:=bridge", "~/imu", "/bridge/imu"),
        ("-r ~/imu:=imu", "~/imu", "/imu"),
        ("-r a:=first -r a:=second", "a", "/first"),
        ("-r a:=b -r b:=c", "a", "/b"),
        ("-r udp_forwarder:a:=b", "a", "/b"),
        ("-r other:a:=b", "a", "/a"),
        ("-r rostopic:///a:=rostopic://b", "a", "/b"),
        ("-r udp_forwarder:rostopic://a:=b", "a", "/b"),
    ],
)
def test_a_topic_is_remapped(line: str, topic: str, expected: str) -> None:
    """Names are qualified by namespace and node before they are compared, and the first rule that matches decides."""
    assert _parsed(line).topic(topic) == expected


@pytest.mark.parametrize(
    ("line", "full_name"),
    [
        ("", "/udp_forwarder"),
        ("-r __ns:=/rover/front", "/rover/front/udp_forwarder"),
        ("-r __ns:=/rover -r __node:=bridge", "/rover/bridge"),
        ("-r udp_forwarder:__node:=bridge", "/bridge"),
        ("-r other:__node:=bridge -r other:__ns:=/x", "/udp_forwarder"),
        ("-r __ns:=/first -r __ns:=/second", "/first/udp_forwarder"),
    ],
)
def test_the_node_is_renamed(line: str, full_name: str) -> None:
    """`__node` and `__ns` name the node; of several rules the first decides, and those of other nodes do not count."""
    assert _parsed(line).node.full_name == full_name


def test_log_levels() -> None:
    """Every level of ROS 2 is taken, in any case, for all loggers or for one; it is info else."""
    assert _parsed("").log_level == "info"
    for level in ros_args.LOG_LEVELS:
        for given in (level, level.upper(), f"udp_forwarder:={level}"):
            assert _parsed(f"--log-level {given}").log_level == level


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--frobnicate"], "unknown argument '--frobnicate' after --ros-args (known: -p"),
        (["-p"], "-p needs a value after it"),
        (["-p", "listen_port=5000"], "the parameter 'listen_port=5000' is not of the form name:=value"),
        (["-p", ":=5000"], "the parameter ':=5000' is not of the form name:=value"),
        (["-p", "a:=[1"], "the value of the parameter a: not valid YAML: expected"),
        (["-p", f"a:={'[' * 1100}"], "the value of the parameter a: not valid YAML: it is nested too deeply"),
        (["-p", f"a:={'9' * 5000}"], f"the value of the parameter a: {'9' * 40}..."),
        (["-r", "imu_data"], "the remap 'imu_data' is not of the form name:=value"),
        (["-r", "imu data:=imu"], "'imu data' in the remap 'imu data:=imu' is not a topic name"),
        (["-r", "imu_data:=2imu"], "'2imu' in the remap 'imu_data:=2imu' is not a topic name"),
        (["-r", "imu_data:=a//b"], "'a//b' in the remap"),
        (["-r", "__node:=my-node"], "'my-node' is not a node name"),
        (["-r", "__ns:=rover"], "'rover' is not a namespace"),
        (["-r", "__ns:=/rover/"], "'/rover/' is not a namespace"),
        (["--log-level", "loud"], "unknown log level 'loud' (known: debug, info, warn, error, fatal)"),
    ],
    ids=lambda value: " ".join(value)[:30] if isinstance(value, list) else "",
)
def test_what_is_not_understood_is_quoted(arguments: list[str], expected: str) -> None:
    """A wrong argument is a `SetupError` that quotes it and says what would be right."""
    assert expected in _refused(*arguments)


def test_the_generated_file_names_what_the_node_has() -> None:
    """The parameter file that ships with the ROS 2 package holds the node's defaults."""
    shipped = _parsed("", "--params-file", str(_GENERATED_FILE)).parameters
    assert shipped["listen_port"] == 5000
    assert parameters.read(REGISTRY, shipped) == parameters.read(REGISTRY, {})


def test_switches_of_every_node_are_taken() -> None:
    """What launch files say to every node does no harm here, and the console can be silenced."""
    line = "--disable-rosout-logs --enable-external-lib-logs -e /rover --log-config-file x.yaml -p a:=1"
    assert _parsed(line).parameters == {"a": 1}
    assert _parsed(line).logs_to_console
    assert not _parsed("--disable-stdout-logs").logs_to_console
    assert _parsed("--disable-stdout-logs --enable-stdout-logs").logs_to_console
    assert not _parsed(line).logs_to_rosout
    assert _parsed("--disable-rosout-logs --enable-rosout-logs").logs_to_rosout
