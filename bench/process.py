"""Child processes: measured bridges, and the tools that generate load and observe arrivals."""

import ctypes
import json
import signal
import subprocess
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import IO, Any, cast

from bench.errors import BenchError
from roverlink.simulation.run_account import resident_bytes

START_SECONDS = 20.0
STOP_SECONDS = 10.0
END_SECONDS = 2.0
QUIET_SECONDS = 0.02
QUIET_SHARE = 0.05  # of one core: DDS threads wake up now and then even without work


def cpu_clock(pid: int) -> int:
    """Return the system's clock of a process's CPU time: all threads, user and kernel mode."""
    clock = ctypes.c_int()
    if ctypes.CDLL(None).clock_getcpuclockid(pid, ctypes.byref(clock)) != 0:
        raise BenchError(f"the system has no CPU clock for process {pid}")
    return clock.value


class Child:
    """Running program whose stderr goes to a log file. A context manager; on exit the program ends."""

    def __init__(self, name: str, command: Sequence[str], environment: Mapping[str, str], logs: Path) -> None:
        self.name = name
        self._log = logs / f"{name}.log"
        with self._log.open("w", encoding="utf-8") as log:
            try:
                self._process = subprocess.Popen(  # noqa: S603  # a contestant or a tool of ours
                    command,
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=log,
                    env=dict(environment),
                    text=True,
                )
            except OSError as error:
                raise BenchError(f"cannot start {name}: {error}") from error
        self._clock = cpu_clock(self._process.pid)

    def __enter__(self) -> "Child":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._process.communicate(timeout=END_SECONDS)  # closes stdin, which ends a tool
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.communicate()

    def cpu_seconds(self) -> float:
        """Return the CPU time used so far."""
        return time.clock_gettime(self._clock)

    def resident_mb(self) -> float:
        """Return the resident memory of the program in megabytes."""
        return (resident_bytes(self._process.pid) or 0) / 1e6

    def ask(self, line: str) -> dict[str, Any]:
        """Send a line to a tool and wait for its answer, one line of JSON."""
        questions, answers = cast(IO[str], self._process.stdin), cast(IO[str], self._process.stdout)  # both are pipes
        try:
            questions.write(line + "\n")
            questions.flush()
        except BrokenPipeError:
            raise self.failure("ended early") from None
        return self._parse(answers.readline())

    def stop(self) -> dict[str, Any]:
        """Interrupt a bridge and return the counts in its last line."""
        self._process.send_signal(signal.SIGINT)
        try:
            output, _ = self._process.communicate(timeout=STOP_SECONDS)
        except subprocess.TimeoutExpired:
            raise self.failure(f"did not stop within {STOP_SECONDS:g} s of SIGINT") from None
        lines = output.splitlines()
        return self._parse(lines[-1] if lines else "")

    def check_running(self) -> None:
        """Raise `BenchError` if the program has ended."""
        if self._process.poll() is not None:
            raise self.failure(f"ended early with status {self._process.returncode}")

    def failure(self, what: str) -> BenchError:
        """Return an error about this program, with the end of its log."""
        tail = self._log.read_text(encoding="utf-8", errors="replace").splitlines()[-5:]
        return BenchError("\n  ".join([f"{self.name} {what} (log: {self._log})", *tail]))

    def _parse(self, line: str) -> dict[str, Any]:
        try:
            answer: dict[str, Any] = json.loads(line)
        except ValueError:
            raise self.failure(f"answered {line!r} instead of a JSON object") from None
        return answer


@dataclass(frozen=True, slots=True)
class UdpSocket:
    """State of a bound UDP socket in the kernel: bytes waiting, and datagrams dropped since it was bound."""

    queued: int
    drops: int


def udp_socket(port: int) -> UdpSocket | None:
    """Return the state of the socket bound to this port, or None."""
    for table in ("/proc/net/udp", "/proc/net/udp6"):
        for line in Path(table).read_text(encoding="ascii").splitlines()[1:]:
            columns = line.split()
            if int(columns[1].rpartition(":")[2], 16) == port:
                return UdpSocket(queued=int(columns[4].partition(":")[2], 16), drops=int(columns[12]))
    return None


def wait_until_bound(child: Child, port: int) -> None:
    """Wait until a bridge listens. The kernel's table tells, so a bridge need not announce it."""
    deadline = time.monotonic() + START_SECONDS
    while udp_socket(port) is None:
        child.check_running()
        if time.monotonic() > deadline:
            raise child.failure(f"did not listen on port {port} within {START_SECONDS:g} s")
        time.sleep(0.01)


def wait_until_quiet(children: Iterable[Child], port: int) -> float:
    """Wait until no data waits at the port and the programs are idle; return the time (monotonic) of idleness."""
    watched = tuple(children)
    deadline = time.monotonic() + STOP_SECONDS
    while True:
        began, used = time.monotonic(), sum(child.cpu_seconds() for child in watched)
        time.sleep(QUIET_SECONDS)
        busy = sum(child.cpu_seconds() for child in watched) - used
        state = udp_socket(port)
        if (state is None or state.queued == 0) and busy < QUIET_SHARE * (time.monotonic() - began):
            return began
        if began > deadline:
            raise watched[0].failure(f"was still busy {STOP_SECONDS:g} s after the load ended")
