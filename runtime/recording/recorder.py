"""Recorder: a thread that writes the messages and datagrams of a bridge to disk.

The bridge's threads only append messages to a queue of limited length. If the disk is too slow or full, messages are
dropped and counted. The bridge never waits for the disk, and no error of the recorder stops the bridge.
"""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from google.protobuf.message import DecodeError

from roverlink.numerals import counted
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.core.periodic_thread import AlarmedThread
from roverlink.runtime.core.registry import Registry
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.recording import file_names
from roverlink.runtime.recording.clocks import RunClock
from roverlink.runtime.recording.mcap_file import Entry
from roverlink.runtime.recording.message_definitions import definition_of
from roverlink.runtime.recording.queued_file import QueuedFile, Settings
from roverlink.runtime.recording.schemas import descriptor_set_of

# The rmw value for an unlimited duration: the largest int64, in nanoseconds.
_FOREVER = {"sec": 9_223_372_036, "nsec": 854_775_807}
_WAKE_S = 0.05
"""Time between two rounds in seconds: short, so that one round holds the interpreter lock only briefly."""
_CALM_S = 0.25
"""The same while most messages come in blocks of the native core, for which a round hardly needs the lock."""
_FEW = 100  # messages that do not
_FLUSH_S = 0.5  # interval of flushes: a kill loses messages of this time, plus those being written
_NEARLY_FULL_S = 300.0  # time until the disk is full, at the current rate, below which a warning is logged


class Recorder:
    """Recorder of a run of the bridge: a thread writes the messages and datagrams to MCAP files.

    A context manager: on exit it writes the waiting messages and closes the files.
    """

    def __init__(
        self,
        path: Path,
        registry: Registry,
        topics: Mapping[str, str],
        logger: logging.Logger,
        settings: Settings | None = None,
        about: Mapping[str, str] | None = None,
    ) -> None:
        """Create the two files of the recording, one for topics and one for datagrams.

        ``topics`` maps fully qualified topics to the names of their rows. ``about`` is additional metadata for the
        files. Raises `SetupError` for a file name that is not allowed, and `OSError` if a file cannot be created.
        """
        self.path = file_names.new_recording(path)
        self._registry, self._rows, self._logger = registry, topics, logger
        settings = settings or Settings()
        metadata = {"fingerprint": registry.fingerprint, "package": registry.package, **(about or {})}
        self._clock = RunClock()
        self._topics = QueuedFile(self.path, file_names.TOPICS, settings, metadata, self._clock)
        try:
            self._datagrams = QueuedFile(
                self.path, file_names.DATAGRAMS, settings, metadata, self._clock, self._plain_or_raw
            )
        except OSError:
            self._topics.delete()
            raise
        self._files = (self._topics, self._datagrams)
        # MCAP's schema encoding `protobuf` is a FileDescriptorSet with all imports, so any reader can decode the
        # datagrams.
        self._envelope = descriptor_set_of(registry.envelope)
        self._channels_lock = threading.Lock()
        self._next_flush = time.monotonic() + _FLUSH_S
        self._bytes_seen = 0
        self._warned = False
        self.failure: str | None = None
        """Reason why the recording failed; None while it works."""
        self._thread = AlarmedThread("record", self._run)
        for queued in self._files:
            queued.wake = self._thread.wake

    # --- channels ---

    def topic(self, topic: str, message_type: type[Message], qos: Qos) -> Tap:
        """Add a topic to the recording, and return the function that takes the topic's serialized messages."""
        row = self._registry.by_name.get(self._rows.get(topic, ""))
        about = (
            {"row": row.route.name, "number": str(row.route.number), "direction": row.route.direction} if row else {}
        )
        with self._channels_lock:
            return self._topics.channel(
                topic,
                "cdr",
                schema_name=message_type.__msgtype__,
                schema_encoding="ros2msg",
                schema=definition_of(message_type).encode(),
                metadata={"offered_qos_profiles": _qos_text(qos), **about},
            )

    def datagrams(self, name: str) -> Tap:
        """Add a channel for datagrams to the recording, and return the function that takes the datagrams.

        ``name`` tells which datagrams the channel has: ``received``, or ``sent/<peer>``.

        A datagram that protobuf cannot parse, because zeros were stripped or appended or because it is damaged, goes to
        the channel ``<name>/raw``. That channel has no schema, because programs that use the schema could not read the
        datagram.
        """
        with self._channels_lock:
            plain = self._datagrams.channel(
                f"/datagrams/{name}",
                "protobuf",
                schema_name=self._registry.envelope.DESCRIPTOR.full_name,
                schema_encoding="protobuf",
                schema=self._envelope,
            )
            self._datagrams.channel(f"/datagrams/{name}/raw", "")  # `_plain_or_raw` relies on the next number
        return plain

    def _plain_or_raw(self, entry: Entry) -> Entry:
        arrived, shown, channel, datagram = entry
        try:
            self._registry.envelope.FromString(datagram)
        except DecodeError:
            return arrived, shown, channel + 1, datagram
        return entry

    # --- counters ---

    @property
    def lost(self) -> int:
        """Number of messages that were not recorded, because the disk was too slow or the recording had failed."""
        return sum(queued.lost_messages for queued in self._files)

    @property
    def waiting(self) -> int:
        """Number of messages that wait to be written."""
        return sum(queued.waiting_messages for queued in self._files)

    @property
    def bytes(self) -> int:
        """Number of bytes on disk, in all files."""
        return sum(queued.bytes for queued in self._files)

    def summary(self) -> str:
        """Return the result of the recording as one line of text."""
        topics, datagrams = (queued.counts.total() for queued in self._files)
        lost = f"; {self.lost} lost because the disk was too slow" if self.lost and not self.failure else ""
        recorded = f"{counted(topics, 'message')} of topics and {counted(datagrams, 'datagram')}"
        return f"recorded {recorded} to {self.path}{lost}"

    # --- writing ---

    def __enter__(self) -> Recorder:
        self._thread.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.__exit__()

    def _run(self) -> None:
        try:
            pause = _CALM_S
            while self._thread.wait(pause):
                pause = _WAKE_S if self._write_waiting() > _FEW else _CALM_S
            self._take()
            for queued in self._files:
                queued.finish()
            if not any(queued.counts for queued in self._files):
                self._delete_files()
                return
        except Exception as error:  # noqa: BLE001  # any error ends the recording, never the bridge
            self._fail(error)
            while self._thread.wait(_CALM_S):  # what still comes is lost, and counted
                for queued in self._files:
                    queued.sources()
        else:
            self._logger.info("%s", self.summary())

    def _delete_files(self) -> None:
        """Delete the files, because they contain no message; otherwise the next run could not use the same name."""
        for queued in self._files:
            queued.delete()
        self._logger.info("nothing was recorded, so %s was not kept", self.path)

    def _take(self) -> int:
        """Write the messages that wait; before, write down if the computer's clock was set.

        Return how many of them had come one by one, and not in blocks.
        """
        if jump := self._clock.jump():
            self._logger.warning(
                "the computer's clock %s; the recording keeps the order and the pace of its messages", jump
            )
            for queued in self._files:
                queued.jumped(jump)
        return sum(queued.take() for queued in self._files)

    def _write_waiting(self) -> int:
        one_by_one = self._take()
        now = time.monotonic()
        if now >= self._next_flush:
            self._next_flush = now + _FLUSH_S
            for queued in self._files:
                queued.file.flush()
            self._check_free_space()
        return one_by_one

    def _check_free_space(self) -> None:
        """Log a warning if the disk will be full within five minutes.

        Log it again only if the disk had more space meanwhile.
        """
        rate, self._bytes_seen = (self.bytes - self._bytes_seen) / _FLUSH_S, self.bytes
        disk = os.statvfs(self.path.parent)
        # f_bavail and not f_bfree: some blocks are reserved for root (statvfs(3)).
        free = disk.f_bavail * disk.f_frsize
        if free >= rate * _NEARLY_FULL_S:
            self._warned = False
        elif not self._warned:
            self._warned = True
            self._logger.warning(
                "the disk is nearly full: %.1f MB free for %s, enough for %.0f s; then the recording stops",
                free / 1e6,
                self.path,
                free / rate,
            )

    def _fail(self, error: Exception) -> None:
        """End the recording because of an error.

        The files on disk stay, and get an end. If the disk is full, their last messages make room for it.
        """
        reason = error.strerror if isinstance(error, OSError) else f"{type(error).__name__}: {error}"
        for queued in self._files:
            queued.give_up()
        self.failure = str(reason)
        self._logger.error("the recording failed (%s); the bridge continues. %s", reason, self.summary())


def _qos_text(qos: Qos) -> str:
    """Return a QoS profile as rosbag2 writes it: a YAML list with one profile, and rmw's enum values as numbers."""
    profile: dict[str, Any] = {
        "history": {"keep_last": 1, "keep_all": 2}[qos.history],
        "depth": qos.depth,
        "reliability": {"reliable": 1, "best_effort": 2}[qos.reliability],
        "durability": {"transient_local": 1, "volatile": 2}[qos.durability],
        "deadline": _FOREVER,
        "lifespan": _FOREVER,
        "liveliness": 1,
        "liveliness_lease_duration": _FOREVER,
        "avoid_ros_namespace_conventions": "false",
    }
    lines = []
    for name, value in profile.items():
        lines.append(f"  {name}:" if isinstance(value, dict) else f"  {name}: {value}")
        if isinstance(value, dict):
            lines += [f"    {part}: {number}" for part, number in value.items()]
    return "\n".join(["-" + lines[0][1:], *lines[1:]])
