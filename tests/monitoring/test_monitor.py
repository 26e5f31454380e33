"""How a bridge is doing is worked out from its account: rates, ages, levels, and what they are told as."""

from __future__ import annotations

import dataclasses
import io
import json
import logging
import urllib.request
from pathlib import Path
from typing import Any

import pytest
from prometheus_client.parser import text_string_to_metric_families
from rich.console import Console

from generated.registry import REGISTRY
from roverlink import standard_types, top_screen
from roverlink.console import LOG_FORMATS
from roverlink.heard_bridges import HeardBridge, HeardBridges, state_of
from roverlink.runtime import Registry, SetupError
from roverlink.runtime.bridge.account import Account, ThrottledWarnings
from roverlink.runtime.bridge.ends import LinkState
from roverlink.runtime.bridge.handling_times import BOUNDS_S, HandlingTimes, Latencies
from roverlink.runtime.bridge.link_exchange import DIFFERS, UNKNOWN, EndReport
from roverlink.runtime.core import cdr
from roverlink.runtime.core.board_clock import ClockReport
from roverlink.runtime.core.link_message import LinkMessage
from roverlink.runtime.core.link_statistics import LinkStatistics
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray, KeyValue
from roverlink.runtime.monitoring import diagnostic_array, prometheus
from roverlink.runtime.monitoring.liveness import Liveness, SilenceLog
from roverlink.runtime.monitoring.monitor import Monitor
from roverlink.runtime.monitoring.state import Budget, Level, Recording, RowState, State
from roverlink.runtime.net.udp import SocketState
from roverlink.runtime.text.values import message_to_values

_SCREEN = Path(__file__).with_name("top.txt")
_STAMP = 1_700_000_000_250_000_000


def _expecting(**rates: int) -> Registry:
    """The registry, with rows that expect a rate."""
    handlers = []
    for handler in REGISTRY.handlers:
        route = dataclasses.replace(handler.route, expect_rate=rates.get(handler.route.name))
        handlers.append(type(handler)())
        handlers[-1].route = route  # type: ignore[misc]  # of this one alone
    return dataclasses.replace(REGISTRY, handlers=tuple(handlers))


class _Bridge:
    """An account, a socket that is half full, and a clock."""

    def __init__(self, **rates: int) -> None:
        self.account = Account()
        self.now, self.kernel_drops = 1000.0, 0
        self.times = HandlingTimes()
        self.recording: Recording | None = None
        self.links: list[EndReport] = []
        self.clocks: dict[EndName, ClockReport] = {}
        self.monitor = Monitor("udp_forwarder", _expecting(**rates), self, lambda: self.recording, lambda: self.now)

    def link_states(self) -> dict[EndName, LinkState]:
        return {}

    def latencies(self) -> Latencies:
        return self.times.latencies

    def socket_state(self) -> SocketState:
        return SocketState(4096, 8192, self.kernel_drops)

    def link_reports(self) -> list[EndReport]:
        return self.links

    def clock_reports(self) -> dict[EndName, ClockReport]:
        return self.clocks

    def let(self, seconds: float, **a_second: int) -> None:
        """Let time pass, with so many messages of a row a second."""
        for _ in range(round(seconds / 0.25)):
            self.now += 0.25
            for name, rate in a_second.items():
                self.account.published[name] += rate // 4
                self.account.received += rate // 4
            self.account.last_crossed |= {name: self.now for name, rate in a_second.items() if rate}
            self.monitor.sample()

    def row(self, name: str) -> RowState:
        return next(row for row in self.monitor.state().rows if row.name == name)


def test_rates_and_ages() -> None:
    """A rate is that of the last two seconds, an age the time since the last message."""
    bridge = _Bridge()
    assert (bridge.row("imu_info").age, bridge.row("imu_info").message) == (None, "no message yet")
    bridge.let(4, imu_info=40, gps_info=8)
    assert (bridge.row("imu_info").rate, bridge.row("gps_info").rate) == (40, 8)
    assert bridge.monitor.state().received_rate == 48
    bridge.let(1, imu_info=40)
    assert bridge.row("gps_info").age == 1.0
    assert bridge.row("gps_info").rate == 4
    assert (bridge.row("imu_info").count, bridge.row("imu_info").age) == (200, 0)


@pytest.mark.parametrize(
    ("a_second", "then_silent", "level", "message"),
    [
        (40, 0, Level.OK, ""),
        (32, 0, Level.OK, ""),
        (28, 0, Level.WARN, "28.0/s; 40/s expected"),
        (40, 3, Level.STALE, "silent for 3.0 s; 40/s expected"),
        (0, 0, Level.STALE, "no message yet; 40/s expected"),
    ],
)
def test_levels_of_a_row_of_which_a_rate_is_expected(
    a_second: int, then_silent: int, level: Level, message: str
) -> None:
    """Too slow is a warning, silent is stale; a fifth less than expected is no matter."""
    bridge = _Bridge(imu_info=40)
    bridge.let(5, imu_info=a_second)
    bridge.let(then_silent)
    assert (bridge.row("imu_info").level, bridge.row("imu_info").message) == (level, message)


def test_what_is_dropped_is_a_warning_for_two_seconds_and_an_error_where_nothing_passes() -> None:
    """Drops of a row are told by reason; refused messages of topics among them."""
    bridge = _Bridge()
    bridge.let(3, imu_info=40)
    bridge.account.dropped["conversion"] += 3
    bridge.account.dropped_of_row["imu_info", "conversion"] += 3
    bridge.account.refused["drive_motor"] += 1
    bridge.let(0.5, imu_info=40)
    row = bridge.row("imu_info")
    assert (row.level, row.message) == (Level.WARN, "dropped in the last 2 s: conversion 3")
    assert (bridge.row("drive_motor").level, bridge.row("drive_motor").dropped) == (Level.ERROR, {"refused": 1})
    assert (bridge.monitor.state().level, bridge.monitor.state().message) == (
        Level.WARN,
        "datagrams or messages lost in the last 2 s: conversion 3, refused 1",
    )
    bridge.let(3, imu_info=40)
    assert (bridge.row("imu_info").level, bridge.row("imu_info").dropped) == (Level.OK, {"conversion": 3})
    assert bridge.monitor.state().level == Level.OK


def test_stops_of_the_deadman() -> None:
    """Their number, and that the peer stands still until the next message; rows without a deadman have neither."""
    bridge = _Bridge()
    assert (bridge.row("imu_info").stops, bridge.row("drive_motor").stops) == (None, 0)
    bridge.account.count_stops("drive_motor", 1)
    bridge.let(0.5)
    row = bridge.row("drive_motor")
    assert (row.stops, row.stopping, row.message) == (1, True, "no message yet; the bridge sends the stop")
    bridge.let(10)
    assert bridge.row("drive_motor").stopping
    bridge.account.count_sent("drive_motor", 1)
    bridge.let(0.5)
    row = bridge.row("drive_motor")
    assert (row.stops, row.stopping, row.message) == (1, False, "")
    bridge.account.count_stops("drive_motor", 2)
    bridge.let(0.25)
    row = bridge.row("drive_motor")
    assert (row.stops, row.stopping, row.message) == (3, True, "silent; the bridge sends the stop")


def test_what_concerns_the_whole_bridge_is_told_of_it() -> None:
    """QoS that does not match is a warning, which the row explains; a recording's end and most data lost are errors."""
    bridge = _Bridge(imu_info=40)
    bridge.let(3, imu_info=40)
    bridge.account.qos_mismatches = {"imu_data": ["a subscription of /viz gets no messages"], "imu/mag": ["another"]}
    row = bridge.row("imu_info")
    assert (row.level, row.message, row.qos_mismatches) == (Level.WARN, "a subscription of /viz gets no messages", 1)
    state = bridge.monitor.state()
    assert (state.level, state.message) == (
        Level.WARN,
        "the QoS of other nodes does not match on imu_data, imu/mag; change the QoS of one side",
    )
    bridge.account.standing = {"generated code": "the generated code is old", "network": ""}
    assert bridge.monitor.state().message == "the generated code is old"
    bridge.recording = Recording("run.mcap", 0, 7, 1000, "No space left on device")
    state = bridge.monitor.state()
    assert (state.level, state.message) == (Level.ERROR, "the recording stopped: No space left on device")
    bridge.recording = None
    for drops, level, lost in ((1, Level.WARN, "1 %"), (124, Level.ERROR, "61 %")):
        bridge.kernel_drops += drops
        bridge.let(0.25, imu_info=40)
        state = bridge.monitor.state()
        text = f"this computer cannot keep up: {lost} of the datagrams lost in the last 2 s; end"
        assert (state.level, state.message[: len(text)]) == (level, text)


def _lines(shown: Any, width: int) -> list[str]:
    """What a terminal shows."""
    console = Console(width=width, record=True, file=io.StringIO())
    console.print(shown)
    return console.export_text().splitlines()


def _printed(state: Any, width: int) -> list[str]:
    """The lines of one bridge's state."""
    return [line.rstrip() for line in _lines(top_screen.printed([HeardBridge(state, 0, 0)], width), width)]


def _reports() -> list[EndReport]:
    """One board with another schema, with measurements; and the basestation, which sends no link messages."""
    statistics = LinkStatistics()
    for index in range(3):
        echo = {"received": 10 * index, "echo_us": 1000 + index, "echo_age_us": 0}
        message = LinkMessage(1, index + 1, sent=10 * index, time_us=index * 1_000_000, hashes={}, **echo)
        statistics.take(message, index * 1_000_000 + 21_000, 9 * index, 10 * index)
    measured = {"senders": 1, "restarts": 2, "age": 0.5, "lost_in": 2, "loss_in": 0.1, "clock_offset_us": -4000}
    rows = ("drive_motor", "drive_diag")
    board = EndReport(EndName("hardware", "Drive"), DIFFERS, rows, (), statistics=statistics, **measured)  # type: ignore[arg-type]
    return [board, EndReport(EndName("basestation"), UNKNOWN, (), ("map",))]


def test_what_the_link_messages_tell_is_in_the_diagnostics_and_on_the_screen_of_top() -> None:
    """A board with another schema is a warning that names its rows; what was measured is told in plain units."""
    bridge = _Bridge()
    bridge.links = _reports()
    array = diagnostic_array.array_of(bridge.monitor.state(), _STAMP, {})
    state = state_of(array)
    assert state is not None
    assert len(state["rows"]) == len(REGISTRY.handlers)
    board, base = state["links"]
    told = {"name": "Drive of hardware", "level": "WARN", "message": "another schema of drive_motor, drive_diag"}
    told |= {"peer": "hardware", "board": "Drive", "lost_in": 2, "loss_in": 0.1, "restarts": 2, "round_trip": 0.02}
    assert told.items() <= board.items()
    assert {"level": "OK", "message": "no link message yet", "schema": "unknown"}.items() <= base.items()
    assert "loss_in" not in base
    shown = "".join(f"{line}\n" for line in _printed(state, 200))
    assert (
        "Drive of hardware: another schema of drive_motor, drive_diag; loss in 10.0%; round trip 20.0 ms; "
        "jitter 0.0 ms; clock -4.0 ms; 2 restarts\n" in shown
    )
    assert "basestation: no link message yet\n" in shown


def test_the_clocks_of_boards_are_on_diagnostics_and_in_the_metrics() -> None:
    """A clock that is not known says why; the end of a board shows no clock that stamps nothing."""
    bridge = _Bridge()
    bridge.clocks = {
        EndName("hardware", "SensorBoard"): ClockReport("", -1.79e9, 2e-5, 3e-4, 2e-4, 1),
        EndName("hardware", "ArmBoard"): ClockReport("stamps are times of receipt: why", None, None, None, None, 0),
    }
    state = bridge.monitor.state()
    shown = state_of(diagnostic_array.array_of(state, 0, {"instance": "a"}))
    assert shown is not None
    ends = {end.get("board"): end for end in shown["ends"]}
    clock = {"clock_offset": -1.79e9, "clock_drift": 2e-5, "clock_uncertainty": 3e-4, "clock_round_trip": 2e-4}
    assert {"stamps": "board", "clock_restarts": 1, **clock}.items() <= ends["SensorBoard"].items()
    assert ends["ArmBoard"]["stamps"] == "receipt"
    assert ends["ArmBoard"]["message"] == "stamps are times of receipt: why"
    assert "stamps" not in ends["DrivingBoard"]
    (peer,) = (one for one in shown["peers"] if one["name"] == "hardware")
    assert {board["name"]: board.get("stamps") for board in peer["boards"]}["ArmBoard"] == "receipt"
    lines = [line for line in prometheus.text_of(state).splitlines() if line.startswith("roverlink_board_clock_")]
    assert 'roverlink_board_clock_known{board="ArmBoard",peer="hardware"} 0.0' in lines
    assert 'roverlink_board_clock_uncertainty_seconds{board="SensorBoard",peer="hardware"} 0.0003' in lines
    assert len(lines) == 7


def test_what_the_link_messages_tell_is_in_the_metrics() -> None:
    """Each measurement is a metric with the labels peer and board, in seconds and shares; unknown ones are missing."""
    bridge = _Bridge()
    bridge.links = _reports()
    text = prometheus.text_of(bridge.monitor.state())
    samples = {
        (sample.name, sample.labels["board"]): sample.value
        for family in text_string_to_metric_families(text)
        for sample in family.samples
        if sample.name.startswith("roverlink_link_")
    }
    assert samples["roverlink_link_schema_differs", "Drive"] == 2
    assert ("roverlink_link_schema_differs", "") not in samples
    assert samples["roverlink_link_lost_in_total", "Drive"] == 2
    assert samples["roverlink_link_clock_offset_seconds", "Drive"] == pytest.approx(-0.004)
    assert samples["roverlink_link_restarts_total", "Drive"] == 2
    bridge.links = []
    assert "roverlink_link_schema" not in prometheus.text_of(bridge.monitor.state())


# --- told -------------------------------------------------------------------------------------------------------


def _busy() -> State:
    """A bridge that has a bit of everything."""
    bridge = _Bridge(imu_info=40, gps_info=4, ph_info=1)
    bridge.account.forwarded["basestation"] = 180
    bridge.account.unsent["basestation"], bridge.account.clocks_ahead["ArmBoard"] = 2, 3
    bridge.kernel_drops = 11
    bridge.account.dropped.update({"malformed": 4, "wrong_direction": 5, "conversion": 3})
    bridge.account.dropped_of_row.update({("arm_ctrl", "wrong_direction"): 5, ("imu_info", "conversion"): 3})
    bridge.account.qos_mismatches = {"gps_data": ["a subscription of /viz gets no messages (durability: ...)"]}
    bridge.let(3, imu_info=40, gps_info=4)
    bridge.let(2.5, imu_info=20)
    bridge.account.sent["drive_motor"] += 3
    bridge.account.stops["arm_ctrl"] += 7
    bridge.account.last_crossed["drive_motor"] = bridge.account.last_stops["arm_ctrl"] = bridge.now
    bridge.recording = Recording("run.mcap", 12, 0, 5_000_000, None)
    state = bridge.monitor.state()
    counts = (0, 10, 100, 60, 10, *[0] * (len(BOUNDS_S) - 4))
    return dataclasses.replace(state, latencies=dataclasses.replace(state.latencies, counts=counts, sum_s=0.01))


def test_the_page_of_top(request: pytest.FixtureRequest) -> None:
    """The screen, as an operator sees it; `--update-cases` writes it anew."""
    state = state_of(diagnostic_array.array_of(_busy(), _STAMP, {}))
    assert state is not None
    shown = "".join(f"{line}\n" for line in _printed(state, 120))
    if request.config.getoption("--update-cases"):
        _SCREEN.write_text(shown, encoding="utf-8")
    assert shown == _SCREEN.read_text(encoding="utf-8")


def _array(name: str, **origin: Any) -> DiagnosticArray:
    """The message of a bridge with a node name."""
    state = dataclasses.replace(_busy(), node=name)
    return diagnostic_array.array_of(state, _STAMP, {"full_name": f"/{name}", "instance": name, **origin})


class _Heard(HeardBridges):
    """What `top` hears, with a clock."""

    def __init__(self, *nodes: str) -> None:
        self.now = 100.0
        super().__init__(nodes, lambda: self.now)

    def hear(self, name: str = "udp_forwarder", after: float = 0.5, **origin: Any) -> None:
        self.now += after
        self.take(cdr.encode(_array(name, **origin)))

    def screen(self, width: int, height: int, view: top_screen.View, *keys: str) -> list[str]:
        """The lines of the screen after some keys."""
        bridges = self.bridges
        top_screen.live(bridges, self, view, width, height)
        for key in keys:
            assert view.press(key, [bridge.state for bridge in bridges])
        return _lines(top_screen.live(bridges, self, view, width, height), width)


def _without(array: DiagnosticArray, status: int, key: str, value: str | None = None) -> bytes:
    """The message, with a value of a status left out or replaced."""
    pairs = array.status[status].values
    kept = [pair for pair in pairs if pair.key != key]
    array.status[status].values = kept if value is None else [*kept, KeyValue(key, value)]
    return cdr.encode(array)


def test_only_bridges_are_heard() -> None:
    """Other nodes speak on /diagnostics, too; of bridges, those that are asked for, with or without a namespace."""
    heard = _Heard()
    assert heard.take(cdr.encode(DiagnosticArray())) is None
    assert heard.take(b"\x00\x01") is None
    assert heard.take(_without(_array("rover"), 0, "received")) is None
    assert heard.take(_without(_array("rover"), 3, "rate", "fast")) is None
    assert heard.take(_without(_array("rover"), 3, "rate", "inf")) is None
    assert heard.bridges == []
    for wanted, found in (("rover", 1), ("/rover", 1), ("rove", 0)):
        heard = _Heard(wanted)
        heard.hear("rover")
        heard.hear("udp_forwarder")
        assert len(heard.bridges) == found


def test_two_bridges_with_one_name_are_told_from_one_that_was_started_again() -> None:
    """They alternate, and both have their places; one that was started again replaces the old one."""
    heard = _Heard()
    for _ in range(2):
        heard.hear(instance="a", pid=12, host="jetson")
    for _ in range(8):
        heard.hear(instance="b", pid=34, host="laptop")
        assert heard.warnings() == []
    assert [bridge.state["node"]["instance"] for bridge in heard.bridges] == ["b"]
    heard.hear(instance="c", pid=56, host="jetson")
    assert heard.warnings() == []
    heard.hear(instance="b", pid=34, host="laptop")
    heard.hear(instance="c", pid=56, host="jetson")
    (warning,) = heard.warnings()
    assert warning.startswith("2 bridges are named '/udp_forwarder'; start one with --ros-args -r __node:=NAME (")
    assert "process 34 on laptop" in warning
    assert "process 56 on jetson" in warning
    assert warning[:60] in heard.screen(80, 24, top_screen.View())[0]
    # Neither characters nor the markup of the library that draws the screen command the terminal.
    heard = _Heard()
    heard.hear("a\x1b[2J[/red]")
    assert "a?[2J[/red]" in heard.screen(100, 24, top_screen.View())[0]


@pytest.mark.parametrize(("width", "height"), [(80, 24), (70, 20), (200, 60), (30, 8), (1, 1)])
def test_the_screen_fits_the_terminal(width: int, height: int) -> None:
    """No line is longer and there are no more lines, with one bridge and with three; the selected row is told."""
    heard = _Heard()
    for name in ("one", "two", "three"):
        heard.hear(name)
        lines = heard.screen(width, height, top_screen.View(), "end")
        assert len(lines) == height
        assert max(map(len, lines)) <= width
        assert height == 1 or lines[-3].startswith("row 21 of 21")


def test_rows_are_sorted_and_filtered() -> None:
    """By keys; the selected row stays selected, and Esc shows everything again."""
    heard, view = _Heard(), top_screen.View()
    heard.hear()

    def names(*keys: str) -> list[str]:
        heard.screen(120, 60, view, *keys)
        return [row["name"] for row in view.rows(heard.bridges[0].state)]

    everything = names()
    assert names("s") == sorted(everything)
    assert names("s")[:3] == ["ph_info", "gps_info", "imu_info"]
    assert names("s")[0] == "imu_info"
    assert names("s")[0] == "ph_info"
    assert names("s")[0] == "imu_info"
    assert names("s") == everything
    assert names("S")[0] == "imu_info"
    assert names("s") == everything
    assert names("p") == ["ph_info", "gps_info", "imu_info"]
    assert names("down", "/", *"IMUx", "backspace", "enter") == ["imu_info"]
    assert names("/", *"q", "enter") == []
    assert names("escape") == everything
    assert view.row == "gps_info"
    assert not view.press("q", [])


def test_diagnostics_are_those_of_ros2() -> None:
    """The bytes are what the definition of diagnostic_msgs, as rosbags has it, reads."""
    array = diagnostic_array.array_of(_busy(), _STAMP, {})
    theirs = cdr.decode(standard_types.message_type("diagnostic_msgs/msg/DiagnosticArray"), cdr.encode(array))
    assert message_to_values(theirs) == message_to_values(array)
    values = message_to_values(theirs)
    assert values["header"]["stamp"] == {"sec": 1_700_000_000, "nanosec": 250_000_000}
    by_name = {status["name"]: status for status in values["status"]}
    assert len(by_name) == 1 + len(REGISTRY.handlers) + 3  # the boards that have rows; this bridge knows no addresses
    imu = by_name["udp_forwarder: imu_info"]
    assert (imu["level"], imu["hardware_id"]) == (1, "hardware")
    assert imu["message"] == "20.0/s; 40/s expected"
    assert {pair["key"]: pair["value"] for pair in imu["values"]}["rate"] == "20.00"
    assert by_name["udp_forwarder: ph_info"]["level"] == 3


def test_prometheus_reads_the_metrics() -> None:
    """The package's own parser takes every line, and finds each number under its label, whatever a node is called."""
    state = dataclasses.replace(_busy(), node='a"b\\c\nd')
    families = {family.name: family for family in text_string_to_metric_families(prometheus.text_of(state))}
    assert families["roverlink_info"].samples[0].labels["node"] == state.node
    kinds = {name: family.type for name, family in families.items()}
    assert kinds["roverlink_received"] == "counter"
    assert kinds["roverlink_rate"] == "gauge"
    assert kinds["roverlink_handling_seconds"] == "histogram"
    rates = {sample.labels["row"]: sample.value for sample in families["roverlink_rate"].samples}
    assert rates["imu_info"] == 20
    (mismatch,) = families["roverlink_qos_mismatches"].samples
    assert (mismatch.labels, mismatch.value) == ({"topic": "gps_data"}, 1)
    (ahead,) = families["roverlink_clocks_ahead"].samples
    assert (ahead.labels, ahead.value) == ({"signer": "ArmBoard"}, 3)
    (drop,) = families["roverlink_row_dropped"].samples
    assert (drop.labels["row"], drop.labels["reason"], drop.value) == ("imu_info", "conversion", 3)
    stops = {sample.labels["row"]: sample.value for sample in families["roverlink_stops"].samples}
    stopping = {sample.labels["row"]: sample.value for sample in families["roverlink_stopping"].samples}
    assert (stops, stopping) == ({"arm_ctrl": 7, "drive_motor": 0}, {"arm_ctrl": 1, "drive_motor": 0})
    buckets = [
        (sample.labels["le"], sample.value)
        for sample in families["roverlink_handling_seconds"].samples
        if sample.name.endswith("_bucket")
    ]
    assert buckets[0] == ("1e-05", 0)
    assert buckets[-1] == ("+Inf", 180)
    assert [value for _, value in buckets] == sorted(value for _, value in buckets)


def test_metrics_are_served() -> None:
    """On /metrics, with Prometheus's content type; anything else is not found; a port in use is told."""
    state = _busy()
    with prometheus.MetricsServer("127.0.0.1", 0, lambda: state) as server:
        with urllib.request.urlopen(f"http://127.0.0.1:{server.port}/metrics") as answer:
            assert answer.headers["Content-Type"] == prometheus.CONTENT_TYPE
            assert answer.read().decode() == prometheus.text_of(state)
        stranger = urllib.request.Request(f"http://127.0.0.1:{server.port}/metrics", headers={"Host": "evil.example"})
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(stranger)
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(f"http://127.0.0.1:{server.port}/nothing")
        with pytest.raises(SetupError, match=f"cannot serve the metrics on TCP port {server.port} of 127.0.0.1"):
            prometheus.MetricsServer("127.0.0.1", server.port, lambda: state)


def test_what_is_used_of_a_budget_is_shown_and_what_did_not_leave() -> None:
    """In the state, on /diagnostics, on the screen, for the page and for Prometheus; the row tells its own losses."""
    bridge = _Bridge()
    peers = [dataclasses.replace(peer, budget=200_000) for peer in REGISTRY.peers if peer.name == "basestation"]
    registry = dataclasses.replace(REGISTRY, peers=tuple(peers))
    monitor = Monitor("udp_forwarder", registry, bridge, clock=lambda: bridge.now)
    bridge.account.undelivered["basestation", "", "over_budget"] = 7
    bridge.account.undelivered_of_row["detected_object", "over_budget"] = 7
    bridge.account.withheld["basestation", "imu_info", "superseded"] = 5
    bridge.account.budget_bytes["basestation"] = 300_000
    bridge.now += 2
    state = monitor.state()
    assert state.budgets == {"basestation": Budget(200_000, 150_000.0, 300_000)}
    assert "not delivered 7" in state.message
    row = next(row for row in state.rows if row.name == "detected_object")
    assert (row.dropped, row.level) == ({"over_budget": 7}, Level.ERROR)
    heard = state_of(diagnostic_array.array_of(state, _STAMP, {}))
    assert heard is not None
    assert heard["node"]["withheld.basestation imu_info superseded"] == 5
    assert {peer["name"]: peer["budget_text"] for peer in heard["peers"]}["basestation"] == "150.0 of 200 kB/s sent"
    console = Console(file=io.StringIO(), width=200)
    console.print(top_screen.printed([HeardBridge(heard, 0, 0)], 200))
    shown = console.file.getvalue()  # type: ignore[attr-defined]
    assert "undelivered: basestation over_budget 7; withheld: basestation imu_info superseded 5" in shown
    assert "basestation: 150.0 of 200 kB/s sent" in shown
    samples = prometheus.text_of(state)
    assert 'roverlink_budget_sent_bytes_total{peer="basestation"} 300000.0' in samples
    assert 'roverlink_withheld_total{payload="imu_info",peer="basestation",reason="superseded"} 5.0' in samples


# --- logging ----------------------------------------------------------------------------------------------------


def test_records_as_json(caplog: pytest.LogCaptureFixture) -> None:
    """An object a line, with the record's facts beside its message."""
    ThrottledWarnings(logging.getLogger("test_monitor")).warn("empty", 'dropped: "nothing"\nat all')
    line = LOG_FORMATS["json"]().format(caplog.records[0])
    assert "\n" not in line
    said = json.loads(line)
    assert said.pop("time") > 1.7e9
    facts = {"subject": "empty", "kept_back": 0}
    assert said == {"level": "warning", "logger": "test_monitor", "message": 'dropped: "nothing"\nat all', **facts}


def test_the_silent_board_is_named_with_its_address(caplog: pytest.LogCaptureFixture) -> None:
    """A status for each peer and board: alive, silent, unreachable, or with an address yet to be learned.

    The log tells a silence and its end.
    """
    log = SilenceLog(logging.getLogger("test_monitor"))
    caplog.set_level(logging.INFO)
    bridge = _Bridge()
    arm, driving, sensor = (EndName("hardware", board) for board in ("ArmBoard", "DrivingBoard", "SensorBoard"))
    links = {
        EndName("basestation"): LinkState(("10.0.0.5:6000", "10.0.0.6:6000"), "unreachable"),
        arm: LinkState(("192.168.0.21:8",), "ok"),
        driving: LinkState(("192.168.0.22:8",), "ok"),
        sensor: LinkState((), "not_learned"),
    }
    bridge.link_states = lambda: links  # type: ignore[method-assign]
    monitor = Monitor("rover", REGISTRY, bridge, clock=lambda: bridge.now)
    bridge.account.last_crossed["arm_feedback"] = bridge.now
    bridge.now += 5
    bridge.account.last_crossed["drive_diag"] = bridge.now
    array = diagnostic_array.array_of(monitor.state(), _STAMP, {})
    told = {status.name: (status.level, status.message) for status in array.status if "link to" in status.name}
    assert told == {
        "rover: link to basestation": (
            Level.ERROR,
            "the network refuses datagrams to its address; 10.0.0.5:6000; 10.0.0.6:6000",
        ),
        "rover: link to ArmBoard of hardware": (Level.STALE, "silent for 5.0 s; 192.168.0.21:8"),
        "rover: link to DrivingBoard of hardware": (Level.OK, "192.168.0.22:8"),
        "rover: link to SensorBoard of hardware": (
            Level.WARN,
            "its address is not known before its first valid datagram",
        ),
    }
    state = state_of(array)
    assert state is not None
    peers = {peer["name"]: peer for peer in state["peers"]}
    boards = {board["name"]: (board["address"], board["link"]) for board in peers["hardware"]["boards"]}
    assert boards["ArmBoard"] == ("192.168.0.21:8", "ok")
    assert boards["SensorBoard"] == ("", "not_learned")
    assert peers["basestation"]["address"] == "10.0.0.5:6000, 10.0.0.6:6000"
    samples = prometheus.text_of(monitor.state())
    assert 'roverlink_silent{board="ArmBoard",peer="hardware"} 1.0' in samples
    assert 'roverlink_link_ok{board="SensorBoard",peer="hardware"} 0.0' in samples
    log.take(monitor.liveness())
    bridge.account.last_crossed["arm_feedback"] = bridge.now
    log.take(monitor.liveness())
    alive, silent = Liveness("alive", 0.0, 3.0), Liveness("silent", 4.0, 3.0)
    for one in (silent, silent, alive):
        log.take({EndName("hardware"): one, arm: one, driving: one, EndName("basestation"): one})
    lines = [
        "ArmBoard of hardware fell silent: no message for 5.0 s",
        "ArmBoard of hardware speaks again after 5 s of silence",
    ]
    for name in ("basestation", arm, driving):
        lines.append(f"{name} fell silent: no message for 4.0 s")
    lines += [f"{name} speaks again after 4 s of silence" for name in ("basestation", arm, driving)]
    assert [record.getMessage() for record in caplog.records] == lines
