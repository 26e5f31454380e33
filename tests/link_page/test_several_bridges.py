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


def _ids(events: Events, count: int) -> list[str]:
    """The names of the bridges in the list, as soon as it has so many that report."""

    def complete(content: dict[str, Any]) -> bool:
        return len(content["bridges"]) == count and all(bridge["place"] for bridge in content["bridges"])

    return [bridge["id"] for bridge in events.until("bridges", complete)["bridges"]]


@pytest.mark.slow
def test_each_browser_selects_its_bridge(page: FollowedPage) -> None:
    """A browser gets the state of the bridge that it asks for, or of the first, and the list and the alarms of all."""
    page.hear("one")
    with Events(page.url, "/two") as waiting:
        assert _ids(waiting, 1) == ["/one"]
        page.hear("two", ages={"imu_info": 9.0})
        assert waiting.next("state")["node"]["name"] == "two"
    for asked, name in (("", "one"), ("/one", "one"), ("/two", "two")):
        with Events(page.url, asked) as events:
            assert events.next("page")["bridge"] == f"/{name}"
            assert events.alarm("peer hardware")["bridge"] == "/two"
        with Events(page.url, asked) as events:
            heard = events.next("bridges")
            levels = {bridge["id"]: bridge["worst"]["level"] for bridge in heard["bridges"]}
            assert (levels, heard["worst"]["level"]) == ({"/one": "WAITING", "/two": "ERROR"}, "ERROR")
            assert events.next("state")["node"]["name"] == name


@pytest.mark.slow
def test_a_bridge_that_was_started_again_keeps_its_place(page: FollowedPage) -> None:
    """Its alarms stay, its log says so, and a browser that shows it goes on with the new process."""
    page.hear("one", instance="a", pid=12, ages={"imu_info": 9.0})
    with Events(page.url, "/one") as events:
        number = events.alarm("peer hardware")["number"]
        page.hear("one", instance="b", pid=34)  # the old process may still be running
        page.hear("one", after=4.0, instance="b", pid=34)
        events.until("bridges", lambda one: [at["place"] for at in one["bridges"]] == ["process 34 on rover"])
    with Events(page.url, "/one") as events:
        alarm = events.alarm("peer hardware")
        assert (alarm["number"], alarm["ended"] is None) == (number, False)
        assert "was started again: process 34 on rover" in events.next("log")["lines"][0]["text"]


@pytest.mark.slow
def test_the_number_of_bridges_is_bounded(page: FollowedPage) -> None:
    """One more bridge is refused with a warning, until another one has been gone for a minute."""
    for number in range(MOST + 1):
        page.hear(f"b{number}")
    with Events(page.url) as events:
        bridges = events.next("bridges")
        assert [bridge["id"] for bridge in bridges["bridges"]] == [f"/b{number}" for number in range(MOST)]
        assert bridges["warnings"] == [f"more than {MOST} bridges are running; select some of them with --node"]
        for number in (0, 2, 3):
            page.hear(f"b{number}", after=21.0)
        page.hear("late")
        while "/late" not in (ids := _ids(events, MOST)):
            pass
        assert ids == ["/b0", "/b2", "/b3", "/late"]


def test_lines_of_the_log_go_to_their_bridge(page: FollowedPage) -> None:
    """Lines that come before the first state are kept until then, and lines of other nodes are not shown."""
    for name, text in (("late", "it begins"), ("camera", "click")):
        page.bridges.take_log(Log(Time(1, 0), 20, name, text))
    page.hear("late")
    page.bridges.take_log(Log(Time(2, 0), 20, "late", "it goes on"))
    with Events(page.url, "/late") as events:
        assert [line["text"] for line in events.next("log")["lines"]] == ["it begins", "it goes on"]
