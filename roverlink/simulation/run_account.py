"""Counts of a simulation, and the check at its end: each sent datagram was delivered, or dropped for a known reason."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from roverlink.numerals import counted
from roverlink.runtime import Reason, Translator
from roverlink.runtime.bridge.account import discrepancies
from roverlink.runtime.core.handler import UNSTAMPED

PUBLISHED = "published"
LINK_MESSAGE = "link message"
_OF_THE_BRIDGE = (
    Reason.NOT_PUBLISHED,
    Reason.SUPERSEDED,
    Reason.UNKNOWN_SOURCE,
    Reason.WRONG_SOURCE,
    Reason.OVER_RATE,
    Reason.OTHER_SCHEMA,
    Reason.REPEATED,
    Reason.STOPPED,
)
"""Reasons for drops that depend on the state of the bridge, so they cannot be predicted from the datagram alone."""
_WARMED_UP = 0.25
_REACHED = 0.95  # of the rate; a short pause of the computer is made up for
_MOST_GROWTH = 8 * 1024 * 1024


def predict(datagram: bytes, translator: Translator, longest: int) -> str:
    """Predict the result of a datagram in a bridge: ``published``, or the reason for its drop, such as ``malformed``.

    The result of a link message, which has no topic, is ``link message``.

    ``longest`` is the length in bytes of the longest datagram that the bridge accepts. An overloaded bridge may drop
    the datagram for another reason.
    """
    if len(datagram) > longest:
        return Reason.OVERSIZED.value
    translation = translator.receive_all([datagram], UNSTAMPED)
    for refusal in translation.refusals:
        return refusal.reason.value
    return LINK_MESSAGE if translation.links else PUBLISHED


@dataclass
class RunTotals:
    """Totals of a simulation: how many datagrams were sent to the bridge, and what happened to them."""

    sent: Counter[str] = field(default_factory=Counter)
    """Number of datagrams sent to the bridge, by predicted result (see `predict`)."""
    seconds: float = 0.0
    """Duration of the run in seconds."""
    played: float = 0.0
    """Time of the last emission in seconds; less than the duration if this computer is too slow for the rate."""
    unsendable: int = 0
    """Number of datagrams that were not sent, because this host's network refused them."""
    commands: int = 0
    """Number of messages published on topics whose messages the bridge sends to peers."""
    arrived: int = 0
    """Number of datagrams that the peers received from the bridge."""
    lost_at_peers: int = 0
    """Number of datagrams that the kernel dropped at the peers' sockets, because this process read them too slowly."""
    account: dict[str, Any] = field(default_factory=dict)
    """Counters of the bridge at its end, with the keys of `roverlink.runtime.bridge.account.Account.as_dict`."""
    memory: list[int] = field(default_factory=list)
    """Resident memory of the bridge's process in bytes, one value per second."""

    def missed_rate(self, wanted: float) -> str:
        """Return the note that fewer datagrams a second were made than ``wanted``; empty if the rate was reached."""
        if self.played >= _REACHED * self.seconds:
            return ""
        reached = wanted * self.played / self.seconds
        return f"missed the rate: {reached:.0f} of {wanted:.0f} datagrams a second, because this computer is too slow"

    def as_dict(self) -> dict[str, Any]:
        """Return all totals as plain values, for JSON."""
        return {
            "sent": dict(sorted(self.sent.items())),
            "seconds": round(self.seconds, 3),
            "commands": self.commands,
            "arrived": self.arrived,
            "lost_at_peers": self.lost_at_peers,
            "bridge": self.account,
            "memory": self.memory,
            "faults": self.faults(),
        }

    def lines(self) -> Iterator[str]:
        """Yield the lines of the report for the user."""
        account = self.account
        hertz = self.sent.total() / self.seconds if self.seconds else 0
        yield f"sent to the bridge: {counted(self.sent.total(), 'datagram')}, {hertz:.0f} a second; it counted them as:"
        ends = {PUBLISHED: account["published"]}
        ends |= {f"dropped: {reason}": count for reason, count in account["dropped"].items()}
        ends |= {"link messages": account["links_received"]} if account["links_received"] else {}
        ends["dropped by the kernel"] = account["kernel_drops"]
        for end, count in ends.items():
            yield f"  {count:>12} {end}"
        yield f"  {sum(ends.values()):>12} in total"
        yield f"published on topics for peers: {counted(self.commands, 'message')}; the bridge counted them as:"
        ends = {"sent to a peer": account["sent"]}
        ends |= {text: sum(account[name].values()) for name, text in _ENDS_OF_COMMANDS.items()}
        ends["overwritten in a full ROS 2 queue"] = self.commands - account["taken"]
        for end, count in ends.items():
            yield f"  {count:>12} {end}"
        yield f"arrived at the peers: {counted(self.arrived, 'datagram')}; the bridge sent:"
        yield f"  {account['sent']:>12} made from messages of topics"
        yield f"  {account['forwarded']:>12} forwarded from other peers"
        yield f"  {sum(account['stops'].values()):>12} stop datagrams, because a topic was silent (deadman)"
        if links := sum(account["links_sent"].values()):
            yield f"  {links:>12} link messages"
        if repeated := sum(account["repeated"].values()):
            yield f"  {repeated:>12} once more, for want of a new one (at_least) or of a response (request)"
        if undelivered := sum(account["undelivered"].values()):
            yield f"  {-undelivered:>12} that did not leave: {', '.join(account['undelivered'])}"
        for end, rows in account["other_schemas"].items():
            yield f"{end} has another schema of {', '.join(rows)}"
        if self.memory:
            first, last = _mebibytes(self.memory[0]), _mebibytes(self.memory[-1])
            yield f"memory of the bridge: {first} after 1 s, {last} at the end"

    def faults(self) -> list[str]:
        """Return a text for each count that does not add up, and one if the bridge's memory has grown too much.

        An example is "sent 10 datagrams, but received or dropped by the kernel: 9". The list is empty if there
        is no fault.
        """
        return [
            *self._lost_before_bridge(),
            *discrepancies(self.account),
            *self._mispredicted(),
            *self._lost_behind_bridge(),
            *self._memory_growth(),
        ]

    def _lost_before_bridge(self) -> Iterator[str]:
        found = self.account["received"] + self.account["kernel_drops"]
        if found != self.sent.total():
            yield f"sent {counted(self.sent.total(), 'datagram')}, but received or dropped by the kernel: {found}"

    def _mispredicted(self) -> Iterator[str]:
        """Yield a text for each reason with more or fewer dropped datagrams than predicted (see `predict`).

        The number may be lower than predicted by the datagrams that were dropped before the bridge parsed them.
        """
        dropped = self.account["dropped"]
        for reason in Reason:
            expected, found = self.sent[reason.value], dropped.get(reason.value, 0)
            # It is unknown which datagrams the kernel dropped, so each prediction may be too high by all of them.
            spared = self.account["kernel_drops"] + sum(dropped.get(other.value, 0) for other in _BEFORE_PARSING)
            # If the newer datagram was dropped, a datagram that comes again is not older than all, but a replay.
            most = expected + (min(spared, self.sent[Reason.OUTDATED.value]) if reason is Reason.REPLAYED else 0)
            if reason not in _OF_THE_BRIDGE and not expected - spared <= found <= most:
                yield f"expected as dropped for {reason.value}: {counted(expected, 'datagram')}, but dropped: {found}"

    def _lost_behind_bridge(self) -> Iterator[str]:
        out = sent_to_peers(self.account)
        found = self.arrived + self.lost_at_peers
        if out != found:
            yield f"the bridge sent {counted(out, 'datagram')} to the peers; arrived or dropped by the kernel: {found}"
        if self.account["taken"] > self.commands:
            yield f"published {counted(self.commands, 'message')}, but the bridge received {self.account['taken']}"

    def _memory_growth(self) -> Iterator[str]:
        # The first quarter is warm-up: caches fill and pools grow.
        warm = self.memory[int(len(self.memory) * _WARMED_UP) :]
        if warm and warm[-1] - warm[0] > _MOST_GROWTH:
            yield f"the bridge's memory grew from {_mebibytes(warm[0])} to {_mebibytes(warm[-1])}"


def sent_to_peers(account: dict[str, Any]) -> int:
    """Return how many datagrams the bridge has sent to peers, by its account."""
    alone = sum(sum(account[name].values()) for name in ("stops", "links_sent", "repeated"))
    return int(account["sent"] + account["forwarded"] + alone - sum(account["undelivered"].values()))


_ENDS_OF_COMMANDS = {
    "refused": "refused: a value cannot be converted",
    "superseded": "superseded: a newer message replaced it before it was sent",
    "unchanged": "unchanged: the last one had the same payload (on_change)",
    "late": "late: a link held it back for more than a second",
    "failed": "failed: the network refused the datagram",
}
"""Texts for the counters of messages that the bridge did not send to a peer."""
_BEFORE_PARSING = (Reason.UNKNOWN_SOURCE, Reason.OVER_RATE, Reason.STOPPED)


def resident_bytes(pid: int) -> int | None:
    """Return the resident memory of a process in bytes; None if the system does not report it."""
    try:
        pages = Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1]
    except OSError:
        return None
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def _mebibytes(size: int) -> str:
    return f"{size / 1024**2:.1f} MiB"
