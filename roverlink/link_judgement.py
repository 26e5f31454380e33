"""Judgement of a bridge's state: which peers are alive, how each row is, what is wrong, and what is the worst.

`roverlink top` and the page of the link show this judgement and have no rules of their own. The page only adds that its
own connection is lost. The states are results of `roverlink.heard_bridges.state_of`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import Any, NamedTuple

from roverlink.runtime.core.registry import EndName
from roverlink.runtime.monitoring.liveness import link_age, liveness_of
from roverlink.runtime.monitoring.monitor import ADDRESS_PROBLEMS

_STATES = ("alive", "silent", "never", "listens")
"""States of peers and boards; that of a peer is the first that one of its boards has."""
_BADNESS = ("OK", "IDLE", "REST", "WAITING", "WARN", "UNKNOWN", "SILENT", "ERROR", "STOP")
_WORTH_A_LOOK = 0.1
"""Share of lost datagrams from which on the loss of an end is a warning. Above one half, it is an error."""


class Condition(NamedTuple):
    """Fault of a part of the link, with an advice."""

    level: str
    """WARN, SILENT or ERROR; UNKNOWN if the state is old. Of the worst condition also OK, or WAITING for a peer."""
    text: str
    """Description of the fault and its meaning for the operator."""
    advice: str = ""
    """Action that may end the fault; empty if there is none."""


_QUIET = Condition(
    "UNKNOWN",
    "the bridge no longer reports, and all that is known is old",
    "If the bridge was killed, nobody sends stops: use the emergency stop. Then look at the bridge's terminal.",
)


def badness(level: str) -> int:
    """Return a number that is greater the worse a level is; a level of which nothing is known is the worst."""
    return _BADNESS.index(level) if level in _BADNESS else len(_BADNESS)


def old(state: Mapping[str, Any]) -> dict[str, Any]:
    """Return a state of a bridge that no longer publishes it: nothing is known now of its peers, boards and rows."""
    unknown = {"state": "UNKNOWN"}
    peers = [
        {**peer, **unknown, "boards": [{**board, **unknown} for board in peer["boards"]]} for peer in state["peers"]
    ]
    return {**state, "quiet": True, "peers": peers, "rows": [{**row, "verdict": "UNKNOWN"} for row in state["rows"]]}


def worst_of(state: Mapping[str, Any]) -> Condition:
    """Return the worst condition of a bridge and all its parts; a peer or board that has not spoken yet is WAITING."""
    waiting = ", ".join(_waiting(state["peers"]))
    calm = (
        Condition("WAITING", f"no message yet from {waiting}", "Start it, or check its power, cable and address.")
        if waiting
        else Condition("OK", state["node"]["message"])
    )
    boards = (board for peer in state["peers"] for board in peer["boards"])
    # A silent board is no alarm of its own if its peer has been silent as long, but it is not OK either.
    silent = (_silence(board) for board in boards if board["state"] == "silent")
    return worst([*conditions_of(state).values(), *silent, calm])


def worst(conditions: Iterable[Condition]) -> Condition:
    """Return the worst of several conditions, the first one of several equally bad ones."""
    return max(conditions, key=lambda condition: badness(condition.level), default=Condition("OK", ""))


def _waiting(peers: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    for peer in peers:
        if peer["state"] == "never":
            yield peer["name"]
        else:
            yield from (board["name"] for board in peer["boards"] if board["state"] == "never")


def conditions_of(state: Mapping[str, Any]) -> dict[str, Condition]:
    """Return what is wrong in a state, by subject; of equally bad conditions, the first ones are the most important."""
    if state["quiet"]:
        return {"bridge": _QUIET}
    ends = [(peer["name"], peer) for peer in state["peers"]]
    ends += [(f"{board['name']} of {peer['name']}", board) for peer in state["peers"] for board in peer["boards"]]
    parts = (
        _of_node(state["node"]),
        _silences(state["peers"]),
        _stops(state["rows"]),
        _of_links(ends),
        _of_rows(state["rows"]),
    )
    return dict(chain.from_iterable(parts))


def _of_node(node: Mapping[str, Any]) -> Iterator[tuple[str, Condition]]:
    if node["level"] != "OK":
        yield "bridge", Condition(_shown_level(node), node["message"], "The log says more.")


def _silences(peers: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, Condition]]:
    for peer in peers:
        if peer["state"] == "silent":
            advice = "Check its power, and the switch, cable or radio of the whole network."
            yield f"peer {peer['name']}", _silence(peer, advice)
        for board in peer["boards"]:
            # Boards that fall silent together are one alarm, that of the peer. So a board has an alarm only if the peer
            # has spoken since the board was due. The alarm stays if the rest of the peer falls silent later.
            if board["state"] == "silent" and board["age"] - peer["age"] > board["silent_after"]:
                yield f"board {board['name']} of {peer['name']}", _silence(board)


def _silence(end: Mapping[str, Any], advice: str = "Check its power and its cable, and restart it.") -> Condition:
    return Condition("ERROR", f"{end['name']} is silent: no message for {end['age']:.0f} s", advice)


def _stops(rows: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, Condition]]:
    for row in rows:
        if _stop_of(row) == "STOP":
            since = f"for {row['age']:.0f} s" if "age" in row else "any more"
            text = f"no command {row['name']} {since}: the bridge tells {row.get('board') or row['peer']} to stop"
            advice = "Check the program that commands it, and its network. The next command ends the stop."
            yield f"stop {row['name']}", Condition("ERROR", text, advice)


def _of_links(ends: Sequence[tuple[str, Mapping[str, Any]]]) -> Iterator[tuple[str, Condition]]:
    """Yield what the link messages and the addresses of peers and boards tell."""
    for owner, end in ends:
        if end["differing"]:
            text = f"{end['name']} runs other protos: {', '.join(end['differing'])} may be misread"
            yield (
                f"schema {owner}",
                Condition("WARN", text, "Do not drive with it. Flash it, or see `roverlink doctor`."),
            )
    for owner, end in ends:
        if end["loss_level"] != "OK":
            text = f"{end['name']} loses {100 * end['loss']:.0f} % of the datagrams to or from this computer"
            advice = "Slow down. Check the load of this computer first, then the radio and the cable."
            yield f"loss {owner}", Condition(end["loss_level"], text, advice)
    for owner, end in ends:
        # An address that is not learned is no alarm, as no message yet is none.
        if end.get("link") != "not_learned" and (problem := ADDRESS_PROBLEMS.get(end.get("link", ""))):
            text = f"{end['name']} gets no commands: {end.get('fault', problem[1])}"
            advice = "Check the cable and the network interface, or set another address."
            yield f"link {owner}", Condition(problem[0].name, text, advice)


def _of_rows(rows: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, Condition]]:
    for row in rows:
        if row["level"] != "OK":
            advice = "Check the program or sensor that sends it. The log says more."
            yield f"row {row['name']}", Condition(_shown_level(row), f"{row['name']}: {row['message']}", advice)


def judge_rows(rows: Sequence[dict[str, Any]], peers: Sequence[Mapping[str, Any]]) -> None:
    """Add to each row its ``verdict``, the word for its state, and the ``reason``, a text that can be empty.

    STOP: the bridge sends the stop after a command. REST: it sends the stop, and no command has come yet. SILENT: the
    row, or the peer or board at its other end, is silent. IDLE: no message yet. Otherwise it is OK, WARN or ERROR.
    """
    by_name = {peer["name"]: peer for peer in peers}
    for row in rows:
        peer = by_name[row["peer"]]
        ends = [peer, *(board for board in peer["boards"] if board["name"] == row.get("board"))]
        verdict, reason = max((_seen_from(row, end) for end in ends), key=lambda seen: badness(seen[0]))
        row["verdict"] = _stop_of(row) or verdict
        row["reason"] = "; ".join(filter(None, [row["message"], reason]))


def _seen_from(row: Mapping[str, Any], end: Mapping[str, Any]) -> tuple[str, str]:
    """Return the verdict and the reason that a row has with a peer or board at its other end."""
    if row["level"] != "OK" or not row["count"]:
        return (_shown_level(row) if row["level"] != "OK" else "IDLE"), ""
    if end["state"] == "silent":
        return "SILENT", f"{end['name']} is silent"
    if row["name"] in end["differing"]:
        return "WARN", f"{end['name']} runs other protos"
    if end["loss_level"] != "OK":
        return "WARN", f"{end['name']} loses {100 * end['loss']:.0f} %"
    return "OK", ""


def _stop_of(row: Mapping[str, Any]) -> str:
    """Return STOP for a stop that interrupts commands, REST for the one before the first command, else nothing."""
    return ("STOP" if row["count"] else "REST") if row.get("stopping") else ""


def _shown_level(entry: Mapping[str, Any]) -> str:
    """Return the word for the level of a status: ROS 2 calls what is silent STALE."""
    return "SILENT" if entry["level"] == "STALE" else str(entry["level"])


def peers_of(
    node: Mapping[str, Any],
    rows: Sequence[dict[str, Any]],
    ends: Sequence[Mapping[str, Any]] = (),
    links: Sequence[Mapping[str, Any]] = (),
) -> list[dict[str, Any]]:
    """Return the peers of the rows and ends.

    The ``state`` of each is alive, silent, never (no message has come yet) or listens (it only receives). ``age`` is
    the time since its last message; None if there was none. ``rate_in`` and ``rate_out`` are messages a second.
    ``boards`` are the boards of the peer, with the same keys; a peer with boards is alive if one of them is.

    ``ends`` are the ends of the link in the bridge's state. A peer or board with an address of its own has this
    ``address`` and ``link``, the state of the address. ``links`` are the results of the link messages; a peer or board
    with a result has it as ``report``. ``differing`` are the rows of which it has other protos, ``loss`` is the larger
    share of the datagrams that are lost in one of the two directions, and ``loss_level`` is OK, WARN or ERROR. A board
    whose clock stamps messages has ``stamps``, board or receipt, and ``clock_uncertainty`` in seconds if it is known.
    """
    # A peer to which rows are only forwarded has no row of its own.
    names = dict.fromkeys(entry["peer"] for entry in (*rows, *ends))
    ages = {EndName(link["peer"], link.get("board", "")): link["age"] for link in links if "age" in link}
    peers = [_peer(name, node, rows, ends, ages) for name in names]
    end_of = {(end["peer"], end.get("board", "")): end for end in ends}
    report_of = {(link["peer"], link.get("board", "")): link for link in links}
    for peer in peers:
        for board, shown in (("", peer), *((board["name"], board) for board in peer["boards"])):
            end = end_of.get((peer["name"], board))
            if end is not None and (not board or end.get("address") != peer.get("address")):
                shown |= {"address": end.get("address", ""), "link": end["link"]}
                shown |= {"fault": end["fault"]} if "fault" in end else {}
            if end is not None:
                shown |= {key: end[key] for key in ("stamps", "clock_uncertainty") if key in end}
            report = report_of.get((peer["name"], board), {})
            shown |= {"report": report} if report else {}
            shown["differing"] = report["differing"].split(", ") if report.get("differing") else []
            shown["loss"] = loss = max(report.get("loss_in", 0.0), report.get("loss_out", 0.0))
            shown["loss_level"] = "ERROR" if loss > 0.5 else "WARN" if loss > _WORTH_A_LOOK else "OK"
    return peers


def _peer(
    name: str,
    node: Mapping[str, Any],
    rows: Sequence[dict[str, Any]],
    ends: Sequence[Mapping[str, Any]],
    ages: Mapping[EndName, float],
) -> dict[str, Any]:
    own = [row for row in rows if row["peer"] == name]
    boards = dict.fromkeys(entry.get("board", "") for entry in (*own, *ends) if entry["peer"] == name)
    # The rows without a board are a part as well.
    parts = [
        _end(board, [row for row in own if row.get("board", "") == board], link_age(ages, EndName(name, board)))
        for board in boards
    ]
    return {
        **_end(name, own, link_age(ages, EndName(name))),
        "state": min((part["state"] for part in parts), key=_STATES.index, default="listens"),
        "boards": [part for part in parts if part["name"]],
        "stopping": [row["name"] for row in own if _stop_of(row) == "STOP"],
        "resting": [row["name"] for row in own if _stop_of(row) == "REST"],
        "forwarded": node.get(f"forwarded.{name}", 0),
        "unsent": node.get(f"unsent.{name}", 0),
        "budget_text": _budget_text(node.get(f"budget.{name}"), node.get(f"budget_used.{name}", 0)),
    }


def _budget_text(budget: float | None, used: float) -> str:
    """Return what is sent of a budget, both in bytes a second, as text; empty without a budget."""
    return "" if budget is None else f"{used / 1000:.1f} of {budget / 1000:g} kB/s sent"


def _end(name: str, rows: list[dict[str, Any]], age_of_link: float | None) -> dict[str, Any]:
    """Return what peers and boards have in common; ``silent_after`` is the age at which the end counts as silent."""
    inbound = [row for row in rows if row["direction"].endswith("_to_ros")]
    liveness = liveness_of(((row.get("age"), row.get("expect_rate")) for row in inbound), age_of_link)
    rate_in = sum(row["rate"] for row in inbound)
    return {
        "name": name,
        **liveness._asdict(),
        "rate_in": rate_in,
        "rate_out": sum(row["rate"] for row in rows) - rate_in,
    }
