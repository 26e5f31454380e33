"""Parameters and the log of the node, as a real rclpy node sees them."""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from judge import Bridge, Judge, interface, parameters
from polling import wait_until
from rclpy import parameter as rclpy_parameter
from rclpy.parameter import parameter_value_to_python
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import deserialize_message, serialize_message

from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import UINT8, Primitive, Sequence, Text, fields_of
from roverlink.runtime.interfaces import rcl_interfaces as rcl

Start = Callable[..., Bridge]

rclpy_only = pytest.mark.parametrize("middleware", ["rclpy"], indirect=True)
dds_only = pytest.mark.parametrize("middleware", ["dds"], indirect=True)

_SERVICES = {
    "describe_parameters": "rcl_interfaces/srv/DescribeParameters",
    "get_parameter_types": "rcl_interfaces/srv/GetParameterTypes",
    "get_parameters": "rcl_interfaces/srv/GetParameters",
    "list_parameters": "rcl_interfaces/srv/ListParameters",
    "set_parameters": "rcl_interfaces/srv/SetParameters",
    "set_parameters_atomically": "rcl_interfaces/srv/SetParametersAtomically",
}


def _call(judge: Judge, service: str, **fields: Any) -> Any:
    type_name = _SERVICES[service]
    return judge.call(f"/udp_forwarder/{service}", type_name, interface(type_name).Request(**fields))


def _get(judge: Judge, *names: str) -> list[Any]:
    return [parameter_value_to_python(value) for value in _call(judge, "get_parameters", names=names).values]


def _set_together(judge: Judge, **changes: Any) -> Any:
    return _call(judge, "set_parameters_atomically", parameters=parameters(**changes)).result


@pytest.fixture
def new_board() -> Iterator[socket.socket]:
    """A socket to which a peer may move."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(0.2)
        yield sock


@rclpy_only
def test_parameters_are_shown_and_changed(judge: Judge, bridge: Start, new_board: socket.socket) -> None:
    """`ros2 param` shows the values of the command line and what is read-only; a new value moves a peer at once.

    A host is followed, and one that is not known is a warning.
    """
    running = bridge("-p", "max_datagram:=1000", "-p", "source_policy:=any", "-p", "forward_policy:=all")
    listed = _call(judge, "list_parameters").result.names
    assert {"listen_port", "dst_ip", "dst_a_port", "dst_b_port", "max_datagram"} <= {*listed}
    assert _get(judge, "max_datagram", "source_policy") == [1000, "any"]
    listen, peer = _call(judge, "describe_parameters", names=["listen_port", "dst_a_port"]).descriptors
    assert (listen.read_only, peer.read_only) == (True, False)
    assert (peer.integer_range[0].from_value, peer.integer_range[0].to_value) == (1, 65535)
    assert peer.description == "UDP port of the peer basestation"

    port = new_board.getsockname()[1]
    assert [one.successful for one in judge.set_parameters("/udp_forwarder", dst_a_port=port)] == [True]
    running.program.wait_for(f"parameter dst_a_port is now {port}")
    assert _get(judge, "dst_a_port") == [port]
    wait_until(lambda: _heard_after(running, new_board), "a forwarded datagram")
    moved = {"dst_ip": "localhost", "dst_a_port": 6123, "forward_policy": "mapping"}
    assert _set_together(judge, **moved).successful
    assert _set_together(judge, **{**moved, "dst_a_port": port, "forward_policy": "all"}).successful
    wait_until(lambda: _heard_after(running, new_board), "a forwarded datagram")
    assert [one.successful for one in judge.set_parameters("/udp_forwarder", dst_ip="board.invalid")] == [True]
    running.program.wait_for("board.invalid cannot be resolved")


def _heard_after(running: Bridge, board: socket.socket) -> bool:
    """Send a datagram of a board; true if the peer gets one."""
    running.send(imu_info={"accel_x": 1.0})
    try:
        return bool(board.recv(2048))
    except TimeoutError:
        return False


@rclpy_only
def test_what_cannot_be_set_is_refused(judge: Judge, bridge: Start) -> None:
    """ROS 2 is told why, the value stays, and so does that of the parameter that was set together with it."""
    bridge()
    for name, value, reason in (
        ("listen_port", 5001, "read-only"),
        ("listen_address", "127.0.0.2", "read-only"),
        ("dst_b_port", 0, "out of range"),
        ("forward_policy", "none", "it must be one of mapping, all"),
        ("dst_ip", "no host", "is neither an IP address nor the name of a host"),
        ("dst_ip", 7, "type"),
        ("use_sim_time", True, "read-only"),
    ):
        before = _get(judge, name, "source_policy")
        result = _set_together(judge, **{"source_policy": "any", name: value})
        assert (result.successful, reason in result.reason) == (False, True), (name, result)
        assert _get(judge, name, "source_policy") == before


@rclpy_only
def test_a_dumped_file_starts_a_bridge_with_the_same_parameters(judge: Judge, bridge: Start, tmp_path: Path) -> None:
    """What `ros2 param dump` writes is good for `--params-file`, and `ros2 param load` sets what may change."""
    running = bridge("-p", "max_datagram:=1000", "-p", "source_policy:=any", "-p", "dst_a_port:=6123")
    names = _call(judge, "list_parameters").result.names
    file = tmp_path / "udp_forwarder.yaml"
    dumped = dict(zip(names, _get(judge, *names)))
    file.write_text(yaml.safe_dump({"/udp_forwarder": {"ros__parameters": dumped}}), encoding="utf-8")
    running.program.interrupt()
    bridge("--params-file", str(file), "-p", "listen_port:=0", "-p", "dst_a_port:=6124")
    wait_until(lambda: _get(judge, "dst_a_port") == [6124], "the second bridge")
    assert _get(judge, "max_datagram", "source_policy") == [1000, "any"]
    if not hasattr(rclpy_parameter, "parameter_dict_from_yaml_file"):
        pytest.skip("rclpy reads such files from Iron on")
    loaded = rclpy_parameter.parameter_dict_from_yaml_file(str(file), target_nodes=["/udp_forwarder"])
    results = _call(judge, "set_parameters", parameters=list(loaded.values())).results
    refused = {name for name, result in zip(loaded, results) if not result.successful}
    assert {"listen_port", "listen_address", "max_datagram"} <= refused
    assert not refused & {"dst_ip", "dst_a_port", "dst_b_port", "forward_policy", "source_policy", "receive_buffer"}
    assert _get(judge, "dst_a_port") == [6123]


@dds_only
def test_a_fast_dds_client_sees_no_services_that_would_not_answer(
    judge: Judge, bridge: Start, environment: dict[str, str]
) -> None:
    """Calls of a Fast DDS client would never return, so `dds` offers no parameter services."""
    environment["RMW_IMPLEMENTATION"] = "rmw_fastrtps_cpp"  # whatever the judge uses
    bridge()
    judge.wait_for_node("/udp_forwarder")
    assert not judge.node.get_service_names_and_types_by_node("udp_forwarder", "/")


@dds_only
def test_a_cyclone_client_sees_the_parameter_services(judge: Judge, bridge: Start, environment: dict[str, str]) -> None:
    """With RMW_IMPLEMENTATION of Cyclone DDS, `dds` offers the services under the names and types of ROS 2."""
    environment["RMW_IMPLEMENTATION"] = "rmw_cyclonedds_cpp"
    bridge()
    judge.wait_for_node("/udp_forwarder")
    wanted = [(f"/udp_forwarder/{name}", [type_name]) for name, type_name in _SERVICES.items()]

    def offered() -> list[tuple[str, list[str]]]:
        return sorted(judge.node.get_service_names_and_types_by_node("udp_forwarder", "/"))

    wait_until(lambda: offered() == wanted, f"{wanted}")


_LOG = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # lines from before we subscribe, too


def test_the_log_is_on_rosout(judge: Judge, bridge: Start) -> None:
    """A late joiner too gets the lines that are on the console, as the log of the node; the console has them once."""
    running = bridge()
    first = running.program.wait_for("fingerprint of table and schema")
    heard = judge.hear("/rosout", "rcl_interfaces/msg/Log", _LOG)
    text = first.partition("]: ")[2]
    wait_until(lambda: text in [line["msg"] for line in heard.values], f"{text!r} on /rosout")
    line = next(line for line in heard.values if line["msg"] == text)
    assert (line["level"], line["name"]) == (20, "udp_forwarder")
    assert line["stamp"]["sec"] > 0
    assert running.program.errors.count(first) == 1


def test_the_log_stays_off_rosout_if_the_user_wants(judge: Judge, bridge: Start) -> None:
    """With `--disable-rosout-logs`, no line of the bridge is on /rosout."""
    heard = judge.hear("/rosout", "rcl_interfaces/msg/Log", _LOG)
    first = bridge("--disable-rosout-logs").program.wait_for("fingerprint of table and schema")
    judge.wait_for_node("/udp_forwarder")
    bridge("-r", "__node:=loud").program.wait_for("fingerprint of table and schema")
    wait_until(lambda: "loud" in {line["name"] for line in heard.values}, "the other bridge's log")
    assert "udp_forwarder" not in {line["name"] for line in heard.values}, first


@pytest.mark.parametrize(
    ("ours", "type_name"),
    [(one, one.__msgtype__) for one in vars(rcl).values() if getattr(one, "__module__", "") == rcl.__name__],
)
def test_our_messages_are_those_of_ros_2(ours: Any, type_name: str) -> None:
    """Rosidl's class has the fields of ours, reads what we write, and writes what we read as the same message."""
    package, kind, name = type_name.split("/")
    theirs = interface(f"{package}/{kind}/{name.partition('_')[0]}")
    if kind == "srv":
        theirs = getattr(theirs, name.partition("_")[2])
    filled = _filled(ours)
    read = deserialize_message(cdr.encode(filled), theirs)
    assert read.get_fields_and_field_types().keys() == {field.name for field in fields_of(ours)}
    assert cdr.decode(ours, serialize_message(read)) == filled


def _filled(field_type: Any) -> Any:
    """A value of a type, in which nothing is empty or zero."""
    if isinstance(field_type, Primitive):
        return {"?": True, "d": 0.5}.get(field_type.format, 7)
    if isinstance(field_type, Text):
        return "text"
    if isinstance(field_type, Sequence):
        element = _filled(field_type.element)
        return bytes([element]) if field_type.element == UINT8 else [element]
    return field_type(*[_filled(field.type) for field in fields_of(field_type)])
