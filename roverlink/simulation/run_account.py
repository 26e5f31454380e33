"""Reckoning up a run: every datagram that was sent is found again, as delivered, or as dropped with its reason."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from roverlink.runtime import DatagramError, Reason, Translator
from roverlink.runtime.bridge.account import discrepancies

PUBLISHED = "published"
_OF_THE_BRIDGE = (
    Reason.NOT_PUBLISHED,
    Reason.SUPERSEDED,
    Reason.UNKNOWN_SOURCE,
    Reason.WRONG_SOURCE,
    Reason.OVER_RATE,
    Reason.STOPPED,
)
"""Reasons that do not lie in a datagram alone."""
_WARMED_UP = 0.25
_MOST_GROWTH = 8 * 1024 * 1024


def fate(datagram: bytes, translator: Translator, longest: int) -> str:
    """What a bridge that has room for everything does with a datagram: ``published``, or the reason of its drop."""
    if len(datagram) > longest:
        return Reason.OVERSIZED.value
    try:
        translator.receive(datagram)
    except DatagramError as error:
        return error.reason.value
    return PUBLISHED


@dataclass
class Reckoning:
    """What was sent to a bridge, and what came of it."""

    sent: Counter[str] = field(default_factory=Counter)
    """Datagrams to the bridge, by their fate."""
    seconds: float = 0.0
    """How long it took."""
    unsendable: int = 0
    """Datagrams that our own network refused."""
    commands: int = 0
    """Messages published for the bridge to take."""
    arrived: int = 0
    """Datagrams that the peers got of the bridge."""
    lost_at_peers: int = 0
    """Datagrams that the kernel dropped at the peers, who were too slow."""
    account: dict[str, Any] = field(default_factory=dict)
    """What the bridge says, as `roverlink.runtime.bridge.account.Account.as_dict`."""
    memory: list[int] = field(default_factory=list)
    """Resident bytes of the bridge's process, a second apart."""

    def as_dict(self) -> dict[str, Any]:
        """All of it as plain values, for JSON."""
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
        """Where every datagram went."""
        account = self.account
        hertz = self.sent.total() / self.seconds if self.seconds else 0
        yield f"{self.sent.total()} datagrams were sent to the bridge, {hertz:.0f} a second:"
        ends = {PUBLISHED: account["published"], **account["dropped"], "lost in the kernel": account["kernel_drops"]}
        for end, count in ends.items():
            yield f"  {count:>12} {end}"
        yield f"  {sum(ends.values()):>12} in all"
        yield f"{self.commands} messages were published for it to send:"
        ends = {"sent": account["sent"], **{name: sum(account[name].values()) for name in _ENDS_OF_COMMANDS}}
        ends["overwritten in ROS 2's queues"] = self.commands - account["taken"]
        for end, count in ends.items():
            yield f"  {count:>12} {end}"
        yield f"{self.arrived} datagrams reached the peers: {account['sent']} of topics, "
        yield f"  {account['forwarded']} forwarded raw, {sum(account['stops'].values())} to stop"
        if self.memory:
            first, last = _mebibytes(self.memory[0]), _mebibytes(self.memory[-1])
            yield f"memory of the bridge: {first} after 1 s, {last} at the end"

    def faults(self) -> list[str]:
        """Where the sums do not agree, or memory has grown; empty where all is well."""
        return [*self._lost(), *discrepancies(self.account), *self._misjudged(), *self._astray(), *self._grown()]

    def _lost(self) -> Iterator[str]:
        found = self.account["received"] + self.account["kernel_drops"]
        if found != self.sent.total():
            yield f"{self.sent.total()} datagrams were sent, but {found} received or lost in the kernel"

    def _misjudged(self) -> Iterator[str]:
        """Drops for a reason that lies in the datagram alone are known beforehand, but for those lost before."""
        dropped = self.account["dropped"]
        for reason in Reason:
            expected, counted = self.sent[reason.value], dropped.get(reason.value, 0)
            spared = self.account["kernel_drops"] + sum(dropped.get(other.value, 0) for other in _BEFORE_PARSING)
            if reason not in _OF_THE_BRIDGE and not expected - spared <= counted <= expected:
                yield f"{expected} datagrams were {reason.value}, but {counted} counted as that"

    def _astray(self) -> Iterator[str]:
        out = self.account["sent"] + self.account["forwarded"] + sum(self.account["stops"].values())
        found = self.arrived + self.lost_at_peers
        if out != found:
            yield f"the bridge sent {out} datagrams to the peers, but {found} arrived or were lost in the kernel"
        if self.account["taken"] > self.commands:
            yield f"{self.commands} messages were published, but {self.account['taken']} taken"

    def _grown(self) -> Iterator[str]:
        warm = self.memory[int(len(self.memory) * _WARMED_UP) :]
        if warm and warm[-1] - warm[0] > _MOST_GROWTH:
            yield f"the bridge's memory grew from {_mebibytes(warm[0])} to {_mebibytes(warm[-1])}"


_ENDS_OF_COMMANDS = ("refused", "superseded", "failed")
_BEFORE_PARSING = (Reason.UNKNOWN_SOURCE, Reason.OVER_RATE, Reason.STOPPED)


def resident_bytes(pid: int) -> int | None:
    """The memory that a process has in RAM; None where the system does not say."""
    try:
        pages = Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1]
    except OSError:
        return None
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def _mebibytes(size: int) -> str:
    return f"{size / 1024**2:.1f} MiB"
