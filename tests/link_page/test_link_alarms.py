"""What the page judges: which peers and boards are alive, and which alarms there are."""

from __future__ import annotations

from typing import Any

import pytest

from roverlink.link_page.link_alarms import Condition, LinkAlarms, conditions_of, peers_of

_NODE = {"level": "OK", "message": ""}


def _row(board: str, age: float | None, direction: str = "hardware_to_ros", **more: Any) -> dict[str, Any]:
    seen = {} if age is None else {"age": age}
    common = {"name": f"{board} {direction}", "peer": "hardware", "direction": direction, "rate": 1.0, "count": 1}
    return {**common, "level": "OK", "message": "", **({"board": board} if board else {}), **seen, **more}


_DOWN = _row("Lamp", 0.1, "ros_to_hardware")


@pytest.mark.parametrize(
    ("rows", "state", "boards"),
    [
        ([_row("", None)], "never", {}),
        ([_row("", 2.0), _row("", 90.0)], "alive", {}),
        ([_row("", 4.0)], "silent", {}),
        ([_row("", 4.0, expect_rate=0.1)], "alive", {}),
        ([_row("", 31.0, expect_rate=0.1)], "silent", {}),
        ([_row("", 1.0, "ros_to_hardware")], "listens", {}),
        ([_row("Arm", 9.0), _row("", 1.0)], "alive", {"Arm": "silent"}),
        (
            [_row("Arm", 9.0), _row("Drive", 1.0), _row("Lid", None), _DOWN],
            "alive",
            {"Arm": "silent", "Drive": "alive", "Lid": "never", "Lamp": "listens"},
        ),
        (
            [_row("Arm", 9.0), _row("Drive", 4.0), _row("Lid", None), _DOWN],
            "silent",
            {"Arm": "silent", "Drive": "silent", "Lid": "never", "Lamp": "listens"},
        ),
        ([_row("Arm", None), _DOWN], "never", {"Arm": "never", "Lamp": "listens"}),
        ([_DOWN], "listens", {"Lamp": "listens"}),
        ([_row("Arm", 9.0), _row("Lid", 31.0, expect_rate=0.1)], "silent", {"Arm": "silent", "Lid": "silent"}),
        ([_row("Arm", 9.0), _row("Lid", 29.0, expect_rate=0.1)], "alive", {"Arm": "silent", "Lid": "alive"}),
    ],
)
def test_states_of_peers_and_boards(rows: list[dict[str, Any]], state: str, boards: dict[str, str]) -> None:
    """Silent is after three seconds, or three periods of a row that is expected more rarely; boards have their own."""
    (peer,) = peers_of({}, rows)
    assert (peer["state"], {board["name"]: board["state"] for board in peer["boards"]}) == (state, boards)


_AT_REST = {"deadman_after": 0.5, "stops": 3, "stopping": 1}


@pytest.mark.parametrize(
    ("rows", "subjects"),
    [
        ([_row("Arm", 5.0), _row("Drive", 1.0)], ["board Arm of hardware"]),
        ([_row("Arm", 60.0), _row("Drive", 5.0)], ["peer hardware", "board Arm of hardware"]),
        ([_row("Arm", 3.5), _row("Drive", 2.9)], []),
        ([_row("Arm", 4.5), _row("Drive", 3.9)], ["peer hardware"]),
        ([_row("", None, "ros_to_hardware", **_AT_REST, count=0)], []),
        ([_row("", None, "ros_to_hardware", **_AT_REST)], ["stop  ros_to_hardware"]),
    ],
)
def test_which_silence_is_an_alarm(rows: list[dict[str, Any]], subjects: list[str]) -> None:
    """That of a board while the rest speaks; boards that fall silent together are one alarm, that of the peer."""
    state = {"quiet": False, "node": _NODE, "peers": peers_of(_NODE, rows), "rows": rows}
    assert list(conditions_of(state)) == subjects


def test_a_bridge_that_no_longer_reports_is_an_alarm() -> None:
    """Old numbers are not judged: the only alarm is that they are old."""
    silent = {"quiet": True, "node": {"level": "OK"}, "peers": [], "rows": [_row("", None, level="WARN")]}
    assert conditions_of(silent) == {"bridge": Condition("STALE", "the bridge no longer reports its state")}


def test_the_address_and_the_schema_stand_at_their_board() -> None:
    """Each board has the state of its address and the result of its link messages; a fault of either is an alarm."""
    rows = [_row("Arm", 1.0), _row("Drive", 1.0)]
    ends = [
        {"peer": "hardware", "board": "Arm", "link": "not_resolved", "address": ""},
        {"peer": "hardware", "board": "Drive", "link": "not_learned", "address": ""},
        {"peer": "radio", "link": "ok", "address": "239.0.0.7:6000"},
    ]
    differs = {"peer": "hardware", "board": "Drive", "level": "WARN", "message": "another schema of speed"}
    hardware, radio = peers_of(_NODE, rows, ends, [differs])
    arm, drive = hardware["boards"]
    assert (arm["link"], drive["link"], drive["report"]) == ("not_resolved", "not_learned", differs)
    assert "report" not in arm
    assert "report" not in hardware
    assert (radio["name"], radio["state"], radio["address"]) == ("radio", "listens", "239.0.0.7:6000")
    assert conditions_of({"quiet": False, "node": _NODE, "peers": [hardware, radio], "rows": rows}) == {
        "link Arm of hardware": Condition("WARN", "its host cannot be resolved"),
        "schema Drive of hardware": Condition("WARN", "another schema of speed"),
    }


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
