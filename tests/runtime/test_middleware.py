"""Choosing a middleware, rclpy's by way of a stand-in that records how it is used, and the log on /rosout."""

from __future__ import annotations

import dataclasses
import logging
import sys
import threading
import types
from collections.abc import Iterator, Sequence
from typing import Annotated, Any
from unittest.mock import MagicMock, call

import pytest
from polling import PATIENCE_S

from generated.messages import DrivingBoardMotorMessage, ImuSensorInformation
from generated.registry import REGISTRY
from roverlink.runtime import MiddlewareError, Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Bound, Float64, Length, Message
from roverlink.runtime.interfaces import rcl_interfaces
from roverlink.runtime.interfaces.rcl_interfaces import Log
from roverlink.runtime.interfaces.tf2_msgs import TFMessage
from roverlink.runtime.middleware import Endpoint, NodeIdentity, open_middleware
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.middleware.rosout import TOPIC, RosoutHandler
from roverlink.runtime.middleware.serving import ServedTopic, serve
from roverlink.runtime.ros_arguments import parameters
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters

_NODE = NodeIdentity("udp_forwarder", "/rover")

# --- choosing ---------------------------------------------------------------------------------------------------


@pytest.fixture
def absent(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Makes packages impossible to import, and forgets what was imported with them."""

    def make_absent(*names: str) -> None:
        for module in list(sys.modules):
            own = module.startswith("roverlink.runtime.middleware.")
            if own or module.partition(".")[0] in names:
                monkeypatch.delitem(sys.modules, module)
        for name in names:
            monkeypatch.setitem(sys.modules, name, None)

    return make_absent


@pytest.mark.parametrize(
    ("name", "python", "machine", "packages", "said"),
    [
        ("rclpy", 13, "x86_64", ["rclpy"], ["rclpy cannot be imported", "source /opt/ros/humble/setup.bash"]),
        ("dds", 13, "x86_64", ["cyclonedds"], ["Cyclone DDS cannot be imported", "pip install cyclonedds"]),
        # Where there is no wheel of Cyclone DDS, as on the Jetson, the error says what works instead.
        ("dds", 13, "aarch64", ["cyclonedds"], ["no wheel for aarch64", "--middleware rclpy"]),
        ("dds", 14, "x86_64", ["cyclonedds"], ["no wheel for Python 3.14", "--middleware zenoh"]),
        ("auto", 13, "x86_64", ["cyclonedds", "rclpy"], ["pip install cyclonedds"]),
        ("zenoh", 13, "x86_64", ["zenoh"], ["zenoh cannot be imported", "pip install eclipse-zenoh xxhash"]),
        ("mqtt", 13, "x86_64", [], ["unknown middleware 'mqtt' (known: auto, dds, rclpy, zenoh, memory)"]),
    ],
)
def test_a_middleware_that_is_not_there_is_told(
    absent: Any,
    monkeypatch: pytest.MonkeyPatch,
    name: str,
    python: int,
    machine: str,
    packages: list[str],
    said: list[str],
) -> None:
    """The error says what to install or to source; `auto` ends with Cyclone DDS, which could be installed."""
    absent(*packages)
    with monkeypatch.context() as computer:
        computer.setattr("platform.machine", lambda: machine)
        computer.setattr("sys.version_info", (3, python))
        with pytest.raises(MiddlewareError) as refused:
            open_middleware(name, _NODE)
    assert all(part in str(refused.value) for part in said)
    assert ("aarch64" in str(refused.value)) is (machine == "aarch64")


# --- the order in which a middleware serves its topics ------------------------------------------------------------


@pytest.mark.parametrize(
    ("queues", "priorities", "handled"),
    [
        # An urgent message that arrives meanwhile waits for one small batch only.
        ({"urgent": 0, "first": 100, "second": 100}, (9, 0, 0), [("first", 8), ("urgent", 1), ("second", 8)]),
        # Without an urgent topic a batch is large, but not endless: the other topics get their turn.
        ({"first": 100, "second": 5}, (0, 0), [("first", 64), ("second", 5)]),
    ],
)
def test_topics_are_served_by_their_priority(
    queues: dict[str, int], priorities: tuple[int, ...], handled: list[tuple[str, int]]
) -> None:
    """After each batch of another topic, an urgent message arrives."""
    done: list[tuple[str, int]] = []

    def topic(name: str, priority: int) -> ServedTopic:
        def take(most: int) -> list[bytes]:
            taken = min(most, queues[name])
            queues[name] -= taken
            return [b""] * taken

        def handle(messages: Sequence[bytes]) -> None:
            done.append((name, len(messages)))
            if name != "urgent" and "urgent" in queues:
                queues["urgent"] += 1

        return ServedTopic(types.SimpleNamespace(take=take), handle, priority)

    topics = [topic(name, priority) for name, priority in zip(queues, priorities)]
    serve(topics, topics[-2:])
    assert done == handled


# --- rclpy ------------------------------------------------------------------------------------------------------


class _ExternalShutdown(Exception):  # noqa: N818  # as rclpy names it
    """Somebody else has shut ROS 2 down."""


_IMU_FIELDS = {
    **dict.fromkeys([f"{sensor}_{axis}" for sensor in ("accel", "gyro", "mag") for axis in "xyz"], "float"),
    "is_calibrated": "boolean",
    "state": "comms/SensorState",
    "error_code": "uint8",
}


def _generated(fields: dict[str, str]) -> Any:
    """What we use of a class that rosidl generated."""
    return types.SimpleNamespace(get_fields_and_field_types=lambda: fields)


def _graph_endpoint(node: str, reliability: str, deadline: int = 0, lease: int = 2**63 - 1) -> Any:
    """What we use of a TopicEndpointInfo; the durations are in nanoseconds."""
    named, nanoseconds = types.SimpleNamespace, types.SimpleNamespace
    profile = types.SimpleNamespace(
        reliability=named(name=reliability),
        durability=named(name="VOLATILE"),
        deadline=nanoseconds(nanoseconds=deadline),
        liveliness=named(name="AUTOMATIC"),
        liveliness_lease_duration=nanoseconds(nanoseconds=lease),
    )
    return types.SimpleNamespace(node_name=node, node_namespace="/", qos_profile=profile, topic_type="")


@pytest.fixture
def ros(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """A stand-in for an installed ROS 2, which records its use; `make test-ros2` runs the same code with a real one."""
    for name in [name for name in sys.modules if name.partition(".")[0] in ("rclpy", "rcl_interfaces", "comms")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delitem(sys.modules, "roverlink.runtime.middleware.rclpy", raising=False)
    ros, spinning, end_spin = MagicMock(), threading.Event(), threading.Event()
    ros.node, ros.spinning, ros.end_spin, ros.ending = ros.create_node.return_value, spinning, end_spin, None

    def spin(timeout_sec: float) -> None:
        spinning.set()
        assert end_spin.wait(PATIENCE_S)
        if ros.ending is not None:
            raise ros.ending

    ros.executors.ExternalShutdownException = _ExternalShutdown
    ros.executors.SingleThreadedExecutor.return_value.configure_mock(
        **{"spin_once.side_effect": spin, "create_task.side_effect": lambda task: end_spin.set()}
    )
    ros.parameter.Parameter = lambda name, type_=None, value=None: (name, value)
    ros.serialization.deserialize_message = lambda data, cls: cdr.decode(cls, data)
    ros.node.count_publishers.side_effect = lambda topic: len(ros.node.get_publishers_info_by_topic(topic))
    ros.comms = types.SimpleNamespace(
        ImuSensorInformation=_generated(_IMU_FIELDS), SensorState=_generated({"state": "uint8"})
    )
    names = ("executors", "parameter", "qos", "serialization", "signals")
    parts = {f"rclpy.{name}": getattr(ros, name) for name in names}
    for name, module in {"rclpy": ros, **parts, "rcl_interfaces.msg": rcl_interfaces, "comms.msg": ros.comms}.items():
        monkeypatch.setitem(sys.modules, name, module)
    yield ros
    ros.ending = _ExternalShutdown()
    end_spin.set()
    sys.modules.pop("roverlink.runtime.middleware.rclpy", None)


def test_a_node_of_rclpys_is_ours_alone(ros: Any) -> None:
    """The node has its name and namespace, a context of its own, the parameters, and leaves signals to the program."""
    settings = parameters.read(REGISTRY, {"dst_ip": "10.0.0.7"})
    live = LiveParameters(REGISTRY, settings, logging.getLogger("test_middleware"))
    assert type(open_middleware("auto", _NODE, live)).__name__ == "RclpyMiddleware"  # it is there, so it is taken
    context = ros.Context.return_value
    ros.init.assert_called_once_with(
        args=[], context=context, signal_handler_options=ros.signals.SignalHandlerOptions.NO
    )
    ros.create_node.assert_called_once_with(
        "udp_forwarder", namespace="/rover", context=context, use_global_arguments=False, parameter_overrides=None
    )
    ros.executors.SingleThreadedExecutor.assert_called_once_with(context=context)
    ros.executors.SingleThreadedExecutor().add_node.assert_called_once_with(ros.node)
    declarations = [arguments for arguments, _ in ros.node.declare_parameter.call_args_list]
    declared = {name: (value, descriptor.read_only) for name, value, descriptor in declarations}
    assert (declared["listen_port"], declared["dst_ip"]) == ((5000, True), ("10.0.0.7", False))
    # rclpy asks the callback about declarations too.
    assert [name for name, *_ in ros.node.method_calls].index("add_on_set_parameters_callback") == len(declared)


@pytest.mark.parametrize("simulated", [True, False])
def test_rclpy_knows_whether_the_time_is_simulated(ros: Any, simulated: bool) -> None:
    """The node declares `use_sim_time` by itself, as every node of rclpy; only its value is given."""
    open_middleware("rclpy", _NODE, types.SimpleNamespace(values={"use_sim_time": simulated}))
    assert ros.create_node.call_args.kwargs["parameter_overrides"] == ([("use_sim_time", True)] if simulated else None)
    assert not ros.node.declare_parameter.called


def test_rclpy_lists_endpoints_and_topics(ros: Any) -> None:
    """Node and QoS of each endpoint; what no publisher of ours offers is a demand; topics that have publishers."""
    joystick = _graph_endpoint("joystick", "BEST_EFFORT")
    unknown = _graph_endpoint("_NODE_NAME_UNKNOWN_", "RELIABLE", deadline=1, lease=1)
    ros.node.get_publishers_info_by_topic.side_effect = lambda topic: [joystick] if topic == "/cmd" else []
    ros.node.get_subscriptions_info_by_topic.side_effect = lambda topic: [unknown] if topic == "/imu" else []
    ros.node.get_topic_names_and_types.return_value = [("/cmd", ["comms/msg/Command"]), ("/imu", ["comms/msg/Imu"])]
    middleware = open_middleware("rclpy", _NODE)
    assert middleware.endpoints("/imu", True) == []
    assert middleware.endpoints("/cmd", True) == [Endpoint("/joystick", Qos("best_effort"))]
    assert middleware.endpoints("/imu", False) == [Endpoint("", Qos(), ("deadline", "liveliness"))]
    assert middleware.topics() == {"/cmd": "comms/msg/Command"}


def test_rclpy_spins_while_it_is_entered(ros: Any) -> None:
    """A thread spins the node; leaving ends it before node and context are taken down."""
    with open_middleware("rclpy", _NODE) as middleware:
        assert ros.spinning.wait(PATIENCE_S)
        assert not ros.node.destroy_node.called
    assert ros.mock_calls[-3:] == [
        call.executors.SingleThreadedExecutor().shutdown(),
        call.create_node().destroy_node(),
        call.try_shutdown(context=ros.Context.return_value),
    ]
    middleware.close()
    ros.node.destroy_node.assert_called_once_with()


def test_an_interface_that_is_not_built_is_told(ros: Any) -> None:
    """A message without type support in the installed package is named, with how to build or install it."""
    middleware = open_middleware("rclpy", _NODE)
    with pytest.raises(MiddlewareError, match=r"comms/msg/DrivingBoardMotorMessage is not installed .*colcon"):
        middleware.publisher("/drive_motor", DrivingBoardMotorMessage, Qos())
    sys.modules.pop("comms.msg")
    with pytest.raises(MiddlewareError, match=r"comms/msg/ImuSensorInformation is not installed .*colcon"):
        middleware.subscribe("/imu_data", ImuSensorInformation, Qos(), lambda data: None)
    module = "my_rover.generated.messages.moved"
    moved = type("Moved", (Message,), {"__module__": module, "__msgtype__": "rover/msg/Moved"})
    with pytest.raises(MiddlewareError, match=r"colcon build --base-paths my_rover/generated/ros`"):
        middleware.publisher("/moved", moved, Qos())
    with pytest.raises(MiddlewareError, match=r"apt install ros-\$ROS_DISTRO-tf2-msgs`"):
        middleware.publisher("/tf", TFMessage, Qos())


_WITHOUT_MAG_Z = {name: kind for name, kind in _IMU_FIELDS.items() if name != "mag_z"}


@pytest.mark.parametrize(
    ("name", "installed", "difference"),
    [
        ("ImuSensorInformation", _WITHOUT_MAG_Z, "comms/msg/ImuSensorInformation has no field mag_z"),
        ("ImuSensorInformation", _IMU_FIELDS | {"heat": "float"}, "has a field heat that is unknown here"),
        ("ImuSensorInformation", _WITHOUT_MAG_Z | {"mag_z": "float"}, "have another order"),
        ("ImuSensorInformation", _IMU_FIELDS | {"mag_z": "double"}, "mag_z .* has the type double instead of float"),
        ("SensorState", {"state": "uint8[2]"}, r"state of comms/msg/SensorState has the type uint8\[2\] instead"),
    ],
)
def test_a_stale_interface_is_told(ros: Any, name: str, installed: dict[str, str], difference: str) -> None:
    """An installed message whose fields differ from the generated ones is refused, nested messages included."""
    setattr(sys.modules["comms.msg"], name, _generated(installed))
    with pytest.raises(MiddlewareError, match=rf"ImuSensorInformation is not the one .*{difference}.*colcon build"):
        open_middleware("rclpy", _NODE).publisher("/imu_data", ImuSensorInformation, Qos())


def test_interfaces_of_ros_2_are_compared_too(ros: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Strings, sequences and arrays are spelled as rosidl spells them; a package that is missing comes by apt."""
    fields = {"position": "double[3]", "name": "sequence<string>", "raw": "sequence<uint8, 8>", "unit": "string<4>"}
    kinds = [Annotated[list[Float64], Length(3)], list[str], Annotated[bytes, Bound(8)], Annotated[str, Bound(4)]]
    namespace = {"__msgtype__": "probe_msgs/msg/Probe"}
    probe = dataclasses.make_dataclass("Probe", zip(fields, kinds), bases=(Message,), namespace=namespace)
    middleware = open_middleware("rclpy", _NODE)
    with pytest.raises(MiddlewareError, match=r"apt install ros-\$ROS_DISTRO-probe-msgs`"):
        middleware.publisher("/probe", probe, Qos())
    monkeypatch.setitem(sys.modules, "probe_msgs.msg", types.SimpleNamespace(Probe=_generated(fields)))
    middleware.publisher("/probe", probe, Qos())


@pytest.fixture
def logger() -> Iterator[logging.Logger]:
    """A logger that prints nothing."""
    logger = logging.getLogger("test_rosout")
    logger.setLevel(logging.DEBUG)
    logger.propagate = False
    yield logger
    logger.handlers.clear()


def test_each_line_of_the_log_is_a_message(logger: logging.Logger) -> None:
    """A line has ROS 2's level, the name of the node's logger, the text, and the place that logged it."""
    graph, seen = Graph(), []
    MemoryMiddleware(graph).subscribe(TOPIC, Log, Qos(), seen.extend)
    RosoutHandler(logger, MemoryMiddleware(graph), TOPIC, _NODE)
    for level in ("debug", "info", "warning", "error", "critical"):
        getattr(logger, level)("%d datagrams", 3)
    logs = [cdr.decode(Log, data) for data in seen]
    assert [log.level for log in logs] == [10, 20, 30, 40, 50]
    assert {(log.name, log.msg, log.function) for log in logs} == {
        ("rover.udp_forwarder", "3 datagrams", "test_each_line_of_the_log_is_a_message")
    }
    assert all(log.file == __file__ and log.line and log.stamp.sec for log in logs)


class _Broken(MemoryMiddleware):
    def publisher(self, *_: object) -> Any:
        return self

    def publish(self, messages: Sequence[bytes], /) -> int:
        raise MiddlewareError("the middleware is broken")


@pytest.mark.parametrize("middleware", [_Broken(), MemoryMiddleware()])
def test_a_line_that_cannot_be_published_disturbs_nobody(logger: logging.Logger, middleware: Any) -> None:
    """Neither an error of the middleware nor a text without a UTF-8 form reaches the code that logs."""
    handler = RosoutHandler(logger, middleware, TOPIC, _NODE)
    handler.handle(logger.makeRecord(logger.name, logging.INFO, __file__, 1, "a file name: \udcff", (), None))
