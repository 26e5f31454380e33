"""The page of the link: who may read it, what it costs, and what it judges."""

from __future__ import annotations

import argparse
import json
import logging
import re
import socket
import time
import urllib.error
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest
from polling import PATIENCE_S, wait_until
from programs import Start
from visits import Events, ask, port_of

from bench.watched_link import WatchedLink, watched_link
from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.link_page.event_clients import CLIENTS
from roverlink.link_page.last_values import LastValues, flat
from roverlink.link_page.link_alarms import Condition, LinkAlarms, conditions_of, peers_of
from roverlink.link_page.link_server import LinkServer
from roverlink.link_page.live_page import LivePage
from roverlink.observers import BridgeObservers
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.middleware.tapping import TappedMiddleware
from roverlink.runtime.ros_arguments import parameters, ros_args
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters


@pytest.fixture(scope="module")
def link() -> Iterator[WatchedLink]:
    with watched_link() as made:
        yield made


def _row(state: dict[str, Any], name: str) -> dict[str, Any]:
    return next(row for row in state["rows"] if row["name"] == name)


def test_the_events_show_rows_values_and_log(link: WatchedLink) -> None:
    """A message of a board is counted in its row, its values are those that were sent, and a bad datagram is logged."""
    events = Events(link.url)
    link.send_payload("imu_info", accel_x=1.5)
    values = events.next("values")
    while "imu_info" not in values["rows"]:
        values = events.next("values")
    assert values["rows"]["imu_info"]["accel_x"] == 1.5
    state = events.next("state")
    while not _row(state, "imu_info")["count"]:
        state = events.next("state")
    assert next(peer for peer in state["peers"] if peer["name"] == "hardware")["state"] == "alive"
    link.send(b"\xff\xff")
    lines = events.next("log")["lines"]
    while not any("not a valid PBEnvelope" in line["text"] for line in lines):
        lines = events.next("log")["lines"]
    while not state["node"].get("dropped.malformed"):
        state = events.next("state")
    events.close()
    points = json.loads(ask(link.url, "/history?bridge=/udp_forwarder&row=imu_info&field=accel_x")[1])["points"]
    assert [value for _, value in points] == [1.5]
    ages = json.loads(ask(link.url, "/history?bridge=/udp_forwarder&row=imu_info&field=%23age")[1])["points"]
    assert all(value >= 0 for _, value in ages)
    assert ages
    assert json.loads(ask(link.url, "/history?bridge=/udp_forwarder&row=no_row&field=x")[1])["points"] == []


@pytest.mark.slow
def test_a_command_that_falls_silent_is_an_alarm(link: WatchedLink) -> None:
    """While commands come, nothing is stopping; when they end, the row stops and a latched alarm says so."""
    events = Events(link.url)
    link.driver_speaks = True
    state = events.next("state")
    while _row(state, "drive_motor")["stopping"]:
        state = events.next("state")
    link.driver_speaks = False
    while not _row(state, "drive_motor")["stopping"]:
        state = events.next("state")
    alarm = events.alarm("stop drive_motor", lambda now: now["ended"] is None)
    assert alarm["level"] == "ERROR"
    assert _row(state, "drive_motor")["stops"] > 0
    link.driver_speaks = True
    ended = events.alarm("stop drive_motor", lambda now: now["ended"] is not None)
    link.driver_speaks = False
    events.close()
    assert ended["number"] == alarm["number"]


def test_the_page_names_no_other_site(link: WatchedLink) -> None:
    """The page, its style and its program come from the bridge, so the page works without a network."""
    for path in ("/", "/page.css", "/page.js"):
        status, body = ask(link.url, path)
        assert status == 200
        assert not re.search(rb"""https?:|["'(]//|@import""", body)


@pytest.mark.parametrize("path", ["/", "/events", "/history", "/page.js"])
@pytest.mark.parametrize("host", ["evil.example", "localhost.evil.example", "127.0.0.1.evil", ""])
def test_another_name_for_this_computer_is_refused(link: WatchedLink, path: str, host: str) -> None:
    """A site whose own name resolves to this computer sees nothing (DNS rebinding)."""
    assert ask(link.url, path, Host=host)[0] == 403


@pytest.mark.parametrize(
    "headers",
    [{"Origin": "http://evil.example"}, {"Origin": "null"}, {"Sec-Fetch-Site": "cross-site"}],
)
def test_another_site_reads_no_data(link: WatchedLink, headers: dict[str, str]) -> None:
    """It may link to the page, but gets neither events nor histories, and so holds no connection."""
    assert ask(link.url, "/events", **headers)[0] == 403
    assert ask(link.url, "/history?bridge=/udp_forwarder&row=imu_info&field=accel_x", **headers)[0] == 403
    assert ask(link.url, "/", **headers)[0] == 200


def test_the_page_only_reads(link: WatchedLink) -> None:
    """No method but GET has an effect, and no other file is served."""
    for method in ("POST", "PUT", "DELETE"):
        assert ask(link.url, "/", method)[0] == 501
    for path in ("/link_server.py", "/../__init__.py", "/state"):
        assert ask(link.url, path)[0] == 404
    with socket.create_connection(("127.0.0.1", port_of(link.url)), PATIENCE_S) as sock:
        sock.sendall(b"GET http://[ HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert sock.recv(100).startswith(b"HTTP/1.1 400 ")


def test_thirty_browsers_follow_and_the_next_is_told() -> None:
    """The limit holds, the answer names the reason, and there is room again when a browser leaves."""
    with ExitStack() as stack:
        link = stack.enter_context(watched_link())
        followers = [Events(link.url) for _ in range(CLIENTS)]
        for follower in followers:
            stack.callback(follower.close)
        for follower in followers:
            assert follower.next("state")
        status, body = ask(link.url, "/events")
        assert (status, body.startswith(b"30 browsers show this page already")) == (503, True)
        assert ask(link.url, "/")[0] == 200
        followers.pop().close()

        def has_room() -> bool:
            try:
                Events(link.url).close()
            except urllib.error.HTTPError:
                return False
            return True

        wait_until(has_room, "room for another browser")


def test_a_browser_that_does_not_read_is_dropped() -> None:
    """Its connection ends when its queue and the kernel's buffers are full; another browser gets every event."""
    page = LivePage(logging.getLogger("page"))
    event = b'event: big\ndata: "%s"\n\n' % (b"x" * 100_000)
    with LinkServer("127.0.0.1", 0, page) as server, socket.create_connection(("127.0.0.1", server.port)) as slow:
        slow.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert slow.recv(1) == b"H"
        fast = Events(server.url)
        fast.next("bridges")
        for _ in range(300):
            page.clients.send(event, {})
            assert fast.next("big") == "x" * 100_000
        slow.settimeout(PATIENCE_S)
        got, deadline = 0, time.monotonic() + PATIENCE_S
        while data := slow.recv(1_000_000):
            got += len(data)
            assert time.monotonic() < deadline, "the connection does not end"
        assert got < 300 * len(event)
        fast.close()


def test_extra_topics_stay_unconverted() -> None:
    """The page listens to the rows' own topics only, because one on an extra topic would make the bridge convert."""
    handler = REGISTRY.by_name["imu_info"]
    tapped = TappedMiddleware(MemoryMiddleware(Graph()), LastValues({"/imu_data": "imu_info"}))
    assert tapped.publisher("/imu_data", handler.message_type, handler.route.qos).has_subscribers()
    assert not tapped.publisher("/other", handler.message_type, handler.route.qos).has_subscribers()


def test_bytes_that_are_no_message_show_no_values() -> None:
    """Another node may publish garbage on a topic of a row; the page goes on with the next message."""
    handler = REGISTRY.by_name["imu_info"]
    values = LastValues({"/imu_data": "imu_info"})
    tap = values.topic("/imu_data", handler.message_type, handler.route.qos)
    assert tap is not None
    tap([b"\x00\x01"])
    assert list(values.changes()) == []
    tap([cdr.encode(handler.message_type(accel_x=2.0))])
    assert dict(values.changes())["imu_info"]["accel_x"] == 2.0
    assert list(values.changes()) == []


def test_values_are_flat_and_bounded() -> None:
    """Paths name the fields; long arrays and texts are cut, and what JavaScript cannot hold is text."""
    values = flat({"a": {"b": [1, 2.5]}, "n": float("nan"), "i": 2**60, "t": "x" * 1000, "l": list(range(100))})
    assert (values["a.b[0]"], values["a.b[1]"], values["n"], values["i"]) == (1, 2.5, "nan", str(2**60))
    assert (len(values["t"]), values["l[]"], "l[16]" in values) == (200, "100 elements", False)
    assert len(flat({f"f{number}": number for number in range(1000)})) == 100


def test_alarms_stay_until_they_come_anew() -> None:
    """An alarm that is over stays in the list; a new onset or a worse level has a new number, new words have not."""
    alarms = LinkAlarms()
    alarms.update("b", {"row a": Condition("WARN", "1 lost")}, 1.0)
    alarms.update("b", {"row a": Condition("WARN", "2 lost")}, 2.0)
    alarms.update("other", {}, 2.5)
    alarms.update("b", {}, 3.0)
    (alarm,) = alarms.as_list()
    assert [alarm[key] for key in ("number", "text", "since", "ended")] == [1, "2 lost", 1.0, 3.0]
    alarms.update("b", {"row a": Condition("WARN", "3 lost")}, 4.0)
    alarms.update("b", {"row a": Condition("ERROR", "all lost")}, 5.0)
    assert [(alarm["number"], alarm["level"], alarm["ended"]) for alarm in alarms.as_list()] == [(3, "ERROR", None)]


def _inbound(age: float | None, **more: Any) -> dict[str, Any]:
    seen = {} if age is None else {"age": age}
    common = {"name": "a", "peer": "hardware", "direction": "hardware_to_ros", "rate": 1.0, "count": 1}
    return {**common, "level": "OK", "message": "", **seen, **more}


@pytest.mark.parametrize(
    ("rows", "state"),
    [
        ([_inbound(None)], "never"),
        ([_inbound(2.0), _inbound(90.0)], "alive"),
        ([_inbound(4.0)], "silent"),
        ([_inbound(4.0, expect_rate=0.1)], "alive"),
        ([_inbound(31.0, expect_rate=0.1)], "silent"),
        ([_inbound(1.0, direction="ros_to_hardware")], "listens"),
    ],
)
def test_states_of_a_peer(rows: list[dict[str, Any]], state: str) -> None:
    """A peer is silent after three seconds, or after three periods if it is expected to speak more rarely."""
    assert [peer["state"] for peer in peers_of({}, rows)] == [state]


def test_a_row_at_rest_is_no_alarm() -> None:
    """Until its first command, a row with a deadman is at rest: its stop goes out, but nobody has to be woken."""
    rows = [_inbound(None, direction="ros_to_hardware", deadman_after=0.5, stops=3, stopping=1, count=0)]
    node = {"level": "OK", "message": ""}
    assert conditions_of({"quiet": False, "node": node, "peers": [], "rows": rows}) == {}
    rows[0]["count"] = 1
    assert list(conditions_of({"quiet": False, "node": node, "peers": [], "rows": rows})) == ["stop a"]


def test_a_bridge_that_no_longer_reports_is_an_alarm() -> None:
    """Old numbers are not judged: the only alarm is that they are old."""
    silent = {"quiet": True, "node": {"level": "OK"}, "peers": [], "rows": [_inbound(None, level="WARN")]}
    assert conditions_of(silent) == {"bridge": Condition("STALE", "the bridge no longer reports its state")}


def test_run_serves_the_page(start: Start) -> None:
    """`run --page` tells the address, serves the page there, and ends with it."""
    program = start(
        "run",
        "--middleware",
        "memory",
        "--no-diagnostics",
        "--page",
        "127.0.0.1:0",
        "--ros-args",
        "-p",
        "listen_port:=0",
    )
    url = program.wait_for("page: ").rpartition(" ")[2]
    events = Events(url)
    assert events.next("state")["node"]["name"] == "udp_forwarder"
    assert program.interrupt() == 0


def test_an_address_that_cannot_be_served_is_told(link: WatchedLink, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 2, with the port that is in use; a value that is no address is refused by name."""
    arguments = [
        "run",
        "--middleware",
        "memory",
        "--page",
        str(port_of(link.url)),
        "--ros-args",
        "-p",
        "listen_port:=0",
    ]
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert f"cannot serve the page on TCP port {port_of(link.url)} of 127.0.0.1: another program uses it" in error
    for wrong in ("70000", "::1:80", "page"):
        with pytest.raises(SystemExit) as ended:
            main(["run", "--page", wrong])
        assert ended.value.code == 2
        assert f"argument --page: {wrong!r} is not " in capsys.readouterr().err


def test_a_bridge_without_page_has_no_listener() -> None:
    """Without the option, the bridge gets the middleware that was opened, and no observer."""
    given = {"no_diagnostics": True, "metrics": None, "foxglove": None, "record": None}
    arguments = argparse.Namespace(**given, page=None, page_token=None)
    settings = parameters.read(REGISTRY, {})
    with ExitStack() as stack:
        logger = logging.getLogger("no_page")
        live = LiveParameters(REGISTRY, settings, logger)
        attached = BridgeObservers(arguments, REGISTRY, ros_args.parse([], "bridge"), settings, live, logger, stack)
        middleware = MemoryMiddleware(Graph())
        assert attached.wrap(middleware) is middleware
        assert attached.observers == []
