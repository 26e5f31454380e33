"""Boards below the peers of the page: which are alive, and which alarm their silence is."""

from __future__ import annotations

from typing import Any

from visits import Events

from bench.watched_link import watched_link
from roverlink.link_page.link_alarms import Condition, conditions_of, peers_of


def _row(board: str, age: float | None, direction: str = "hardware_to_ros", **more: Any) -> dict[str, Any]:
    seen = {} if age is None else {"age": age}
    common = {"name": f"{board} {direction}", "peer": "hardware", "direction": direction, "rate": 1.0, "count": 1}
    return {**common, "level": "OK", "message": "", **({"board": board} if board else {}), **seen, **more}


def _states(*rows: dict[str, Any]) -> tuple[str, dict[str, str]]:
    (peer,) = peers_of({}, list(rows))
    return peer["state"], {board["name"]: board["state"] for board in peer["boards"]}


def _subjects(*rows: dict[str, Any]) -> list[str]:
    node = {"level": "OK", "message": ""}
    return list(conditions_of({"quiet": False, "node": node, "peers": peers_of(node, rows), "rows": rows}))


def test_a_bridge_tells_its_boards() -> None:
    """A message makes its own board alive, and no other; commands to a board do not."""
    with watched_link() as link:
        events = Events(link.url)
        link.command()
        link.send_payload("imu_info")
        boards: dict[str, str] = {}
        while boards.get("SensorBoard") != "alive":
            peers = {peer["name"]: peer for peer in events.next("state")["peers"]}
            boards = {board["name"]: board["state"] for board in peers["hardware"]["boards"]}
        events.close()
    assert boards == {"SensorBoard": "alive", "ArmBoard": "never", "DrivingBoard": "never"}
    assert peers["basestation"]["boards"] == []


def test_states_of_boards() -> None:
    """Each board has its own state; the peer is alive if a board is, or a row that belongs to no board."""
    down = _row("Lamp", 0.1, "ros_to_hardware")
    boards = {"Arm": "silent", "Drive": "alive", "Lid": "never", "Lamp": "listens"}
    assert _states(_row("Arm", 9.0), _row("Drive", 1.0), _row("Lid", None), down) == ("alive", boards)
    assert _states(_row("Arm", 9.0), _row("", 1.0)) == ("alive", {"Arm": "silent"})
    assert _states(_row("Arm", 9.0), _row("Drive", 4.0), _row("Lid", None), down)[0] == "silent"
    assert _states(_row("Arm", None), down)[0] == "never"
    assert _states(down)[0] == "listens"


def test_a_slow_board_does_not_hide_that_the_others_are_silent() -> None:
    """Each board has the limit of its own rates, so a peer is silent when all of its boards are."""
    assert _states(_row("Arm", 9.0), _row("Lid", 31.0, expect_rate=0.1))[0] == "silent"
    assert _states(_row("Arm", 9.0), _row("Lid", 29.0, expect_rate=0.1)) == ("alive", {"Arm": "silent", "Lid": "alive"})


def test_a_silent_board_is_an_alarm_of_its_own() -> None:
    """It is, while the rest of the peer speaks, and also when the rest falls silent later."""
    assert _subjects(_row("Arm", 5.0), _row("Drive", 1.0)) == ["board Arm of hardware"]
    assert _subjects(_row("Arm", 60.0), _row("Drive", 5.0)) == ["peer hardware", "board Arm of hardware"]


def test_boards_that_fall_silent_together_are_one_alarm() -> None:
    """The alarm is that of the peer, also at the moment when only the first board is past its limit."""
    assert _subjects(_row("Arm", 3.5), _row("Drive", 2.9)) == []
    assert _subjects(_row("Arm", 4.5), _row("Drive", 3.9)) == ["peer hardware"]


def test_the_address_and_the_schema_stand_at_their_board() -> None:
    """Each board has the state of its address and the result of its link messages; a fault of either is an alarm."""
    node = {"level": "OK", "message": ""}
    rows = [_row("Arm", 1.0), _row("Drive", 1.0)]
    ends = [
        {"peer": "hardware", "board": "Arm", "link": "not_resolved", "address": ""},
        {"peer": "hardware", "board": "Drive", "link": "not_learned", "address": ""},
        {"peer": "radio", "link": "ok", "address": "239.0.0.7:6000"},
    ]
    differs = {"peer": "hardware", "board": "Drive", "level": "WARN", "message": "another schema of speed"}
    hardware, radio = peers_of(node, rows, ends, [differs])
    arm, drive = hardware["boards"]
    assert (arm["link"], drive["link"], drive["report"]) == ("not_resolved", "not_learned", differs)
    assert "report" not in arm
    assert "report" not in hardware
    assert (radio["name"], radio["state"], radio["address"]) == ("radio", "listens", "239.0.0.7:6000")
    assert conditions_of({"quiet": False, "node": node, "peers": [hardware, radio], "rows": rows}) == {
        "link Arm of hardware": Condition("WARN", "its host cannot be resolved"),
        "schema Drive of hardware": Condition("WARN", "another schema of speed"),
    }
