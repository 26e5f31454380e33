"""Choosing a middleware, the one in memory, and rclpy's by way of a stand-in that records how it is used."""

from __future__ import annotations

import contextlib
import dataclasses
import logging
import sys
import threading
import types
from collections.abc import Iterator, Sequence
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import pytest
from polling import PATIENCE_S, wait_until

from generated.messages import DrivingBoardMotorMessage, ImuSensorInformation
from generated.registry import REGISTRY
from roverlink.runtime import MiddlewareError, Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Bound, Float64, Length, Message
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.interfaces import rcl_interfaces
from roverlink.runtime.interfaces.tf2_msgs import TFMessage
from roverlink.runtime.middleware import Endpoint, NodeIdentity, open_middleware
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
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


def _refused(name: str) -> str:
    with pytest.raises(MiddlewareError) as caught:
        open_middleware(name, _NODE)
    return str(caught.value)


def test_rclpy_that_is_not_there_is_told(absent: Any) -> None:
    """Without ROS 2, the error says which file to source."""
    absent("rclpy")
    message = _refused("rclpy")
    assert "rclpy cannot be imported" in message
    assert "source /opt/ros/humble/setup.bash" in message


def test_cyclone_that_is_not_there_is_told(absent: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without Cyclone DDS, the error says what to install."""
    monkeypatch.setattr("platform.machine", lambda: "x86_64")
    absent("cyclonedds")
    message = _refused("dds")
    assert "Cyclone DDS cannot be imported" in message
    assert "pip install cyclonedds" in message
    assert "aarch64" not in message


def test_on_the_jetson_the_error_leads_to_rclpy(absent: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where there is no wheel of Cyclone DDS, the error says so, and what works instead."""
    monkeypatch.setattr("platform.machine", lambda: "aarch64")
    absent("cyclonedds")
    message = _refused("dds")
    assert "no wheel for aarch64" in message
    assert "--middleware rclpy" in message


def test_auto_without_any_says_what_to_do(absent: Any) -> None:
    """With neither ROS 2 nor Cyclone DDS, `auto` is an error of Cyclone DDS's, which could be installed."""
    absent("cyclonedds", "rclpy")
    assert "pip install cyclonedds" in _refused("auto")


def test_auto_does_not_take_an_rclpy_that_does_not_import(
    absent: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """An rclpy on the path that was built for another Python is as good as none: `auto` goes on to dds."""
    absent("cyclonedds", "rclpy")
    monkeypatch.delitem(sys.modules, "rclpy")
    (tmp_path / "rclpy.py").write_text("raise ImportError('built for another Python')")
    monkeypatch.syspath_prepend(tmp_path)
    assert "built for another Python" in _refused("rclpy")
    assert "pip install cyclonedds" in _refused("auto")


def test_an_unknown_middleware_is_told() -> None:
    """A name that is none lists those that are."""
    assert _refused("zenoh") == "unknown middleware 'zenoh' (known: auto, dds, rclpy, memory)"


def test_memory_needs_nothing() -> None:
    """The middleware in memory is always there."""
    with open_middleware("memory", _NODE) as middleware:
        assert isinstance(middleware, MemoryMiddleware)


@pytest.mark.parametrize(("namespace", "full_name"), [("/", "/node"), ("/rover", "/rover/node"), ("/a/b", "/a/b/node")])
def test_a_nodes_full_name(namespace: str, full_name: str) -> None:
    """Namespace and name make the name that `ros2 node list` prints."""
    assert NodeIdentity("node", namespace).full_name == full_name


# --- memory -----------------------------------------------------------------------------------------------------


def test_middlewares_that_share_a_graph_see_each_other() -> None:
    """What one publishes, every subscriber of the topic gets, in order, and no other topic does."""
    graph = Graph()
    with MemoryMiddleware(graph) as talker, MemoryMiddleware(graph) as first, MemoryMiddleware(graph) as second:
        publisher = talker.publisher("/imu", ImuSensorInformation, Qos())
        assert not publisher.has_subscribers()
        seen: list[tuple[str, Sequence[bytes]]] = []
        first.subscribe("/imu", ImuSensorInformation, Qos(), lambda messages: seen.append(("first", messages)))
        second.subscribe("/imu", ImuSensorInformation, Qos(), lambda messages: seen.append(("second", messages)))
        second.subscribe("/other", ImuSensorInformation, Qos(), lambda messages: seen.append(("other", messages)))
        assert publisher.has_subscribers()
        assert publisher.publish([b"a", b"b"]) == 2
        assert seen == [("first", [b"a", b"b"]), ("second", [b"a", b"b"])]


def test_leaving_takes_only_ones_own_subscriptions_away() -> None:
    """A middleware that is left hears nothing more; another on the same graph still does."""
    graph = Graph()
    staying, leaving = MemoryMiddleware(graph), MemoryMiddleware(graph)
    publisher = staying.publisher("/imu", ImuSensorInformation, Qos())
    seen: list[bytes] = []
    staying.subscribe("/imu", ImuSensorInformation, Qos(), seen.extend)
    staying.subscribe("/imu", ImuSensorInformation, Qos(), seen.extend).close()
    with leaving:
        leaving.subscribe("/imu", ImuSensorInformation, Qos(), seen.extend)
        publisher.publish([b"both"])
    publisher.publish([b"one"])
    assert seen == [b"both", b"both", b"one"]


def test_topics_in_memory_have_types() -> None:
    """A topic is listed while it has a publisher."""
    graph = Graph()
    with MemoryMiddleware(graph) as node:
        node.publisher("/imu", ImuSensorInformation, Qos())
        assert MemoryMiddleware(graph).topics() == {"/imu": "comms/msg/ImuSensorInformation"}
    assert MemoryMiddleware(graph).topics() == {}


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
    return types.SimpleNamespace(node_name=node, node_namespace="/", qos_profile=profile)


class _Ros:
    """What rclpy offers of what we use, with the signatures of ROS 2 Humble, and a record of its use."""

    def __init__(self) -> None:
        self.calls: list[tuple[Any, ...]] = []
        self.subscriptions: dict[str, Any] = {}
        self.parameters: dict[str, Any] = {}
        self.change: Any = None
        self.published: list[tuple[str, bytes]] = []
        self.spinning, self.end_spin = threading.Event(), threading.Event()
        self.shut_down_from_outside = False
        self.imu = _generated(_IMU_FIELDS)
        self.endpoint = _graph_endpoint("joystick", "BEST_EFFORT")

    def modules(self) -> dict[str, types.ModuleType]:
        """The modules that are imported."""
        names = ("executors", "parameter", "qos", "signals", "serialization")
        root = types.ModuleType("rclpy")
        executors, parameter, qos, signals, serialization = (types.ModuleType(f"rclpy.{name}") for name in names)
        rcl, rcl_messages = types.ModuleType("rcl_interfaces"), types.ModuleType("rcl_interfaces.msg")
        comms, messages = types.ModuleType("comms"), types.ModuleType("comms.msg")
        root.__dict__.update(
            Context=self.context, init=self.init, create_node=self.create_node, try_shutdown=self.try_shutdown
        )
        root.__path__ = []
        executors.__dict__.update(SingleThreadedExecutor=self.executor, ExternalShutdownException=_ExternalShutdown)
        parameter.__dict__.update(Parameter=lambda name, type_=None, value=None: (name, value))
        qos.__dict__.update(
            QoSProfile=dict,
            ReliabilityPolicy=Enum("ReliabilityPolicy", ["SYSTEM_DEFAULT", "RELIABLE", "BEST_EFFORT"]),
            DurabilityPolicy=Enum("DurabilityPolicy", ["SYSTEM_DEFAULT", "TRANSIENT_LOCAL", "VOLATILE"]),
            HistoryPolicy=Enum("HistoryPolicy", ["SYSTEM_DEFAULT", "KEEP_LAST", "KEEP_ALL"]),
        )
        signals.__dict__.update(SignalHandlerOptions=Enum("SignalHandlerOptions", ["NO", "ALL"]))
        serialization.__dict__.update(deserialize_message=lambda data, cls: cdr.decode(cls, data))
        rcl.__path__ = []
        rcl_messages.__dict__.update(
            ParameterDescriptor=rcl_interfaces.ParameterDescriptor,
            SetParametersResult=rcl_interfaces.SetParametersResult,
        )
        comms.__path__ = []
        messages.__dict__.update(ImuSensorInformation=self.imu, SensorState=_generated({"state": "uint8"}))
        made = (root, executors, parameter, qos, signals, serialization, rcl, rcl_messages, comms, messages)
        return {module.__name__: module for module in made}

    def context(self) -> str:
        return "context"

    def init(
        self, *, args: Any = None, context: Any = None, domain_id: Any = None, signal_handler_options: Any = None
    ) -> None:
        self.calls.append(("init", args, context, domain_id, signal_handler_options.name))

    def create_node(
        self,
        node_name: str,
        *,
        context: Any = None,
        cli_args: Any = None,
        namespace: Any = None,
        use_global_arguments: bool = True,
        parameter_overrides: Any = None,
    ) -> _Ros:
        self.calls.append(("create_node", node_name, namespace, context, use_global_arguments))
        self.overrides = parameter_overrides
        return self

    def declare_parameter(self, name: str, value: Any = None, descriptor: Any = None) -> None:
        assert self.change is None  # rclpy asks the callback about declarations too
        self.parameters[name] = (value, descriptor.read_only)

    def add_on_set_parameters_callback(self, callback: Any) -> None:
        self.change = callback

    def create_publisher(self, msg_type: Any, topic: str, qos_profile: Any) -> Any:
        self.calls.append(("create_publisher", msg_type, topic, qos_profile))
        handle = contextlib.ExitStack()  # entered like a handle of rclpy's
        handle.publish_raw = lambda message: self.published.append((topic, message))  # type: ignore[attr-defined]
        handle.get_subscription_count = lambda: len(self.published)  # type: ignore[attr-defined]
        return types.SimpleNamespace(handle=handle)

    def create_subscription(
        self, msg_type: Any, topic: str, callback: Any, qos_profile: Any, *, raw: bool = False
    ) -> str:
        self.calls.append(("create_subscription", msg_type, topic, qos_profile, raw))
        self.subscriptions[topic] = callback
        return topic

    def destroy_subscription(self, subscription: Any) -> None:
        del self.subscriptions[subscription]

    def count_publishers(self, topic: str) -> int:
        return len(self.get_publishers_info_by_topic(topic))

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        return [("/cmd", ["comms/msg/Command"]), ("/imu", ["comms/msg/Imu"])]

    def get_publishers_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[Any]:
        return [self.endpoint] if topic_name == "/cmd" else []

    def get_subscriptions_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[Any]:
        return [self.endpoint] if topic_name == "/imu" else []

    def executor(self, *, context: Any = None) -> _Ros:
        self.calls.append(("executor", context))
        return self

    def add_node(self, node: Any) -> None:
        assert node is self

    def spin_once(self) -> None:
        self.spinning.set()
        assert self.end_spin.wait(PATIENCE_S)
        if self.shut_down_from_outside:
            raise _ExternalShutdown

    def create_task(self, _: Any) -> None:
        self.end_spin.set()

    def shutdown(self) -> None:
        self.calls.append(("executor.shutdown",))

    def destroy_node(self) -> None:
        self.calls.append(("destroy_node",))

    def try_shutdown(self, *, context: Any = None) -> None:
        self.calls.append(("try_shutdown", context))


def _live() -> LiveParameters:
    settings = parameters.read(REGISTRY, {"dst_ip": "10.0.0.7"})
    return LiveParameters(REGISTRY, settings, logging.getLogger("test_middleware"))


@pytest.fixture
def ros(monkeypatch: pytest.MonkeyPatch) -> Iterator[_Ros]:
    """A stand-in for an installed ROS 2."""
    ros = _Ros()
    for name in [name for name in sys.modules if name.partition(".")[0] in ("rclpy", "rcl_interfaces", "comms")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delitem(sys.modules, "roverlink.runtime.middleware.rclpy", raising=False)
    for name, module in ros.modules().items():
        monkeypatch.setitem(sys.modules, name, module)
    yield ros
    ros.shut_down_from_outside = True
    ros.end_spin.set()
    sys.modules.pop("roverlink.runtime.middleware.rclpy", None)


def test_a_node_of_rclpys_is_ours_alone(ros: _Ros) -> None:
    """The node has its name and namespace, a context of its own, the parameters, and leaves signals to the program."""
    open_middleware("rclpy", _NODE, _live())
    assert ros.calls[:2] == [
        ("init", [], "context", None, "NO"),
        ("create_node", "udp_forwarder", "/rover", "context", False),
    ]
    assert ("executor", "context") in ros.calls
    assert ros.parameters["listen_port"] == (5000, True)
    assert ros.parameters["dst_ip"] == ("10.0.0.7", False)


@pytest.mark.parametrize("simulated", [True, False])
def test_rclpy_knows_whether_the_time_is_simulated(ros: _Ros, simulated: bool) -> None:
    """The node declares `use_sim_time` by itself, as every node of rclpy; only its value is given."""
    open_middleware("rclpy", _NODE, types.SimpleNamespace(values={"use_sim_time": simulated}))
    assert ros.overrides == ([("use_sim_time", True)] if simulated else None)
    assert "use_sim_time" not in ros.parameters


def test_rclpy_changes_what_the_node_can_change(ros: _Ros) -> None:
    """A change reaches the node as a whole; a refusal gives ROS 2 the reason."""
    live, applied = _live(), []
    live.on_change(applied.append)
    open_middleware("rclpy", _NODE, live)
    changes = [types.SimpleNamespace(name=name, value=value) for name, value in (("dst_ip", "::"), ("dst_a_port", 7))]
    assert ros.change(changes).successful
    assert [(changed.dst_ip, changed.addresses[EndName("basestation")].port) for changed in applied] == [("::", 7)]
    result = ros.change([types.SimpleNamespace(name="listen_port", value=7)])
    assert (result.successful, result.reason) == (
        False,
        "the parameter 'listen_port' is read-only; restart the node with -p listen_port:=7",
    )


def test_rclpy_publishes_serialized_messages(ros: _Ros) -> None:
    """A publisher of the installed class is given bytes, on the full name, with the row's quality of service."""
    middleware = open_middleware("rclpy", _NODE)
    qos = Qos(reliability="best_effort", durability="transient_local", history="keep_all", depth=7)
    publisher = middleware.publisher("/rover/imu_data", ImuSensorInformation, qos)
    kind, message_class, topic, profile = ros.calls[-1]
    assert (kind, message_class, topic) == (
        "create_publisher",
        ros.imu,
        "/rover/imu_data",
    )
    assert {name: getattr(value, "name", value) for name, value in profile.items()} == {
        "reliability": "BEST_EFFORT",
        "durability": "TRANSIENT_LOCAL",
        "history": "KEEP_ALL",
        "depth": 7,
    }
    assert not publisher.has_subscribers()
    message = cdr.encode(ImuSensorInformation())
    assert publisher.publish([message, message]) == 2
    assert ros.published == [("/rover/imu_data", message)] * 2
    assert publisher.has_subscribers()


def test_rclpy_subscribes_to_serialized_messages(ros: _Ros) -> None:
    """A subscription is raw, so that its callback gets bytes, with rclcpp's default quality of service."""
    seen: list[bytes] = []
    open_middleware("rclpy", _NODE).subscribe("/imu_data", ImuSensorInformation, Qos(), seen.extend)
    kind, message_class, topic, profile, raw = ros.calls[-1]
    assert (kind, message_class, topic) == ("create_subscription", ros.imu, "/imu_data")
    assert raw is True
    assert {name: getattr(value, "name", value) for name, value in profile.items()} == {
        "reliability": "RELIABLE",
        "durability": "VOLATILE",
        "history": "KEEP_LAST",
        "depth": 10,
    }
    ros.subscriptions["/imu_data"](b"message")
    assert seen == [b"message"]


def test_rclpy_lists_the_endpoints_of_a_topic(ros: _Ros) -> None:
    """Node and QoS of each publisher or subscription; what no publisher of ours offers is a demand."""
    middleware = open_middleware("rclpy", _NODE)
    assert middleware.endpoints("/imu", True) == []
    assert middleware.endpoints("/cmd", True) == [Endpoint("/joystick", Qos("best_effort"))]
    ros.endpoint = _graph_endpoint("_NODE_NAME_UNKNOWN_", "RELIABLE", deadline=1, lease=1)
    assert middleware.endpoints("/imu", False) == [Endpoint("", Qos(), ("deadline", "liveliness"))]


def test_rclpy_lists_the_topics_that_have_publishers(ros: _Ros) -> None:
    """Each with its type; a topic that has subscriptions only is not listed."""
    assert open_middleware("rclpy", _NODE).topics() == {"/cmd": "comms/msg/Command"}


def test_a_subscription_of_rclpy_can_end(ros: _Ros) -> None:
    """Its callback is not called any more."""
    subscription = open_middleware("rclpy", _NODE).subscribe("/imu_data", ImuSensorInformation, Qos(), lambda _: None)
    subscription.close()
    assert ros.subscriptions == {}


def test_rclpy_spins_while_it_is_entered(ros: _Ros) -> None:
    """A thread spins the node; leaving ends it before node and context are taken down."""
    with open_middleware("rclpy", _NODE) as middleware:
        assert ros.spinning.wait(PATIENCE_S)
        assert ("destroy_node",) not in ros.calls
    left = [("executor.shutdown",), ("destroy_node",), ("try_shutdown", "context")]
    assert ros.calls[-3:] == left
    middleware.close()
    assert ros.calls.count(("destroy_node",)) == 1


def test_a_shutdown_from_outside_ends_the_spinning_quietly(ros: _Ros, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where ROS 2 is shut down by somebody else, the thread ends without a traceback."""
    failures: list[Any] = []
    monkeypatch.setattr(threading, "excepthook", failures.append)
    ros.shut_down_from_outside = True
    with open_middleware("rclpy", _NODE):
        ros.end_spin.set()
        wait_until(lambda: "rclpy-spin" not in {thread.name for thread in threading.enumerate()}, "the thread's end")
    assert not failures


def test_an_interface_that_is_not_built_is_told(ros: _Ros) -> None:
    """A message without type support in the installed package is named, with how to build or install it."""
    middleware = open_middleware("rclpy", _NODE)
    with pytest.raises(MiddlewareError, match=r"comms/msg/DrivingBoardMotorMessage is not installed .*colcon"):
        middleware.publisher("/drive_motor", DrivingBoardMotorMessage, Qos())
    sys.modules.pop("comms.msg")
    sys.modules.pop("comms")
    with pytest.raises(MiddlewareError, match=r"comms/msg/ImuSensorInformation is not installed .*colcon"):
        middleware.subscribe("/imu_data", ImuSensorInformation, Qos(), lambda data: None)
    module = "my_rover.generated.messages.moved"
    moved = type("Moved", (Message,), {"__module__": module, "__msgtype__": "rover/msg/Moved"})
    with pytest.raises(MiddlewareError, match=r"colcon build --base-paths my_rover/generated/ros`"):
        middleware.publisher("/moved", moved, Qos())
    with pytest.raises(MiddlewareError, match=r"apt install ros-\$ROS_DISTRO-tf2-msgs`"):
        middleware.publisher("/tf", TFMessage, Qos())


def test_auto_takes_rclpy_where_it_imports(ros: _Ros) -> None:
    """With ROS 2 at hand, `auto` is rclpy."""
    assert type(open_middleware("auto", _NODE)).__name__ == "RclpyMiddleware"


_WITHOUT_MAG_Z = {name: kind for name, kind in _IMU_FIELDS.items() if name != "mag_z"}


@pytest.mark.parametrize(
    ("name", "installed", "difference"),
    [
        ("ImuSensorInformation", _WITHOUT_MAG_Z, "comms/msg/ImuSensorInformation has no field mag_z"),
        ("ImuSensorInformation", _IMU_FIELDS | {"heat": "float"}, "has a field heat that is unknown here"),
        ("ImuSensorInformation", _WITHOUT_MAG_Z | {"mag_z": "float"}, "have another order"),
        ("ImuSensorInformation", _IMU_FIELDS | {"mag_z": "double"}, "mag_z .* has the type double instead of float"),
        (
            "SensorState",
            {"state": "uint8[2]"},
            r"state of comms/msg/SensorState has the type uint8\[2\] instead of uint8",
        ),
    ],
)
def test_a_stale_interface_is_told(ros: _Ros, name: str, installed: dict[str, str], difference: str) -> None:
    """An installed message whose fields differ from the generated ones is refused, nested messages included."""
    setattr(sys.modules["comms.msg"], name, _generated(installed))
    with pytest.raises(MiddlewareError, match=rf"ImuSensorInformation is not the one .*{difference}.*colcon build"):
        open_middleware("rclpy", _NODE).publisher("/imu_data", ImuSensorInformation, Qos())


def test_interfaces_of_ros_2_are_compared_too(ros: _Ros, monkeypatch: pytest.MonkeyPatch) -> None:
    """Strings, sequences and arrays are spelled as rosidl spells them; a package that is missing comes by apt."""
    fields = {"position": "double[3]", "name": "sequence<string>", "raw": "sequence<uint8, 8>", "unit": "string<4>"}
    package, messages = types.ModuleType("probe_msgs"), types.ModuleType("probe_msgs.msg")
    package.__path__ = []
    messages.__dict__.update(Probe=_generated(fields))
    kinds = [Annotated[list[Float64], Length(3)], list[str], Annotated[bytes, Bound(8)], Annotated[str, Bound(4)]]
    namespace = {"__msgtype__": "probe_msgs/msg/Probe"}
    probe = dataclasses.make_dataclass("Probe", zip(fields, kinds), bases=(Message,), namespace=namespace)
    middleware = open_middleware("rclpy", _NODE)
    with pytest.raises(MiddlewareError, match=r"apt install ros-\$ROS_DISTRO-probe-msgs`"):
        middleware.publisher("/probe", probe, Qos())
    for module in (package, messages):
        monkeypatch.setitem(sys.modules, module.__name__, module)
    middleware.publisher("/probe", probe, Qos())
