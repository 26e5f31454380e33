"""Several bridges on one page, as `top --web` shows them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from visits import Events

from bench.followed_page import MOST, FollowedPage, followed_page
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.rcl_interfaces import Log


@pytest.fixture
def page() -> Iterator[FollowedPage]:
    with followed_page() as opened:
        yield opened


def _bridges(events: Events, count: int) -> list[dict[str, Any]]:
    """The list of the bridges, as soon as it has so many that report."""
    while True:
        found: list[dict[str, Any]] = events.next("bridges")["bridges"]
        if len(found) == count and all(bridge["level"] for bridge in found):
            return found


def test_each_browser_selects_its_bridge(page: FollowedPage) -> None:
    """A browser gets the state of the bridge that it asks for, or of the first, and the list and the alarms of all."""
    page.hear("one")
    page.hear("two", ages={"imu_info": 9.0})
    for asked, name in (("", "one"), ("/one", "one"), ("/two", "two")):
        events = Events(page.url, asked)
        assert events.next("page")["bridge"] == f"/{name}"
        assert events.alarm("peer hardware")["bridge"] == "/two"
        events.close()
        events = Events(page.url, asked)
        assert [bridge["id"] for bridge in events.next("bridges")["bridges"]] == ["/one", "/two"]
        assert events.next("state")["node"]["name"] == name
        events.close()


def test_a_bridge_that_appears_later_is_shown(page: FollowedPage) -> None:
    """It comes into the list, and a browser that waited for it gets its state."""
    page.hear("one")
    events = Events(page.url, "/late")
    assert [bridge["id"] for bridge in _bridges(events, 1)] == ["/one"]
    page.hear("late")
    assert events.next("state")["node"]["name"] == "late"
    events.close()


def test_a_bridge_that_was_started_again_keeps_its_place(page: FollowedPage) -> None:
    """Its alarms stay, its log says so, and a browser that shows it goes on with the new process."""
    page.hear("one", instance="a", pid=12, ages={"imu_info": 9.0})
    events = Events(page.url, "/one")
    number = events.alarm("peer hardware")["number"]
    page.hear("one", instance="b", pid=34)  # the old process may still be running
    page.hear("one", after=4.0, instance="b", pid=34)
    (bridge,) = _bridges(events, 1)
    while bridge["place"] != "process 34 on rover":
        (bridge,) = _bridges(events, 1)
    events.close()
    events = Events(page.url, "/one")
    alarm = events.alarm("peer hardware")
    assert (alarm["number"], alarm["ended"] is None) == (number, False)
    assert "was started again: process 34 on rover" in events.next("log")["lines"][0]["text"]
    events.close()


def test_two_bridges_with_one_name_are_both_shown(page: FollowedPage) -> None:
    """Host and process tell them apart, each can be selected, and a warning names the cure."""
    for _ in range(2):
        page.hear("one", instance="a", pid=12)
        page.hear("one", instance="b", pid=34)
    events = Events(page.url)
    first, second = _bridges(events, 2)
    assert (first["name"], first["place"]) == ("/one", "process 12 on rover")
    assert (second["name"], second["place"]) == ("/one", "process 34 on rover")
    events.close()
    events = Events(page.url, second["id"])
    assert "start one with --ros-args -r __node:=NAME" in events.next("bridges")["warnings"][0]
    assert events.next("state")["node"]["pid"] == 34
    events.close()


def test_the_number_of_bridges_is_bounded(page: FollowedPage) -> None:
    """One more bridge is refused with a warning, until another one has been gone for a minute."""
    for number in range(MOST + 1):
        page.hear(f"b{number}")
    events = Events(page.url)
    bridges = events.next("bridges")
    assert [bridge["id"] for bridge in bridges["bridges"]] == [f"/b{number}" for number in range(MOST)]
    assert bridges["warnings"] == [f"more than {MOST} bridges are running; select some of them with --node"]
    for number in (0, 2, 3):
        page.hear(f"b{number}", after=21.0)
    page.hear("late")
    ids = [bridge["id"] for bridge in _bridges(events, MOST)]
    while "/late" not in ids:
        ids = [bridge["id"] for bridge in _bridges(events, MOST)]
    assert ids == ["/b0", "/b2", "/b3", "/late"]
    events.close()


def test_lines_of_the_log_go_to_their_bridge(page: FollowedPage) -> None:
    """Lines that come before the first state are kept until then, and lines of other nodes are not shown."""
    for name, text in (("late", "it begins"), ("camera", "click")):
        page.bridges.take_log(Log(Time(1, 0), 20, name, text))
    page.hear("late")
    page.bridges.take_log(Log(Time(2, 0), 20, "late", "it goes on"))
    events = Events(page.url, "/late")
    lines = events.next("log")["lines"]
    assert [line["text"] for line in lines] == ["it begins", "it goes on"]
    events.close()
