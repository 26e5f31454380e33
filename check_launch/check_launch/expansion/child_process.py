"""Work in a child process with limits of time, memory and file size.

Python launch files are programs, and other files can be made to expand without end. So the work is done in a child
process: it has a temporary working folder and no terminal, and it ends with everything that it has started. The child
has the rights of the user. It protects the check from files that do not end, not the computer from strangers.
"""

from __future__ import annotations

import contextlib
import fcntl
import multiprocessing
import os
import pickle
import resource
import signal
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, TypeVar, cast

Result = TypeVar("Result")

_LARGEST_RESULT = 256 << 20  # bytes
_PIPE = 1 << 20  # bytes, which is what Linux allows everybody (pipe(7))
_LOOK = 0.5  # seconds from one look at the processor time to the next
_PROCESSES = Path("/proc")


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a child process."""

    seconds: float = 10.0
    """Most processor time until the next result, and longest time in which the child does nothing but wait."""
    memory: int = 1 << 30
    """Most bytes of memory that the child may allocate."""
    file_size: int = 16 << 20
    """Most bytes of each file that the child writes."""


DEFAULT_LIMITS = Limits()
AT_ONCE = min(4, os.cpu_count() or 1)
"""Most processes beside each other. Each may take a gibibyte of memory."""


class ChildEndedError(Exception):
    """Raised if a child process ended before its work was done; the text is the reason."""


class ChildWaitsError(ChildEndedError):
    """Raised if a child process has waited too long, without processor time."""


def started(work: Callable[[], Iterable[Result]], limits: Limits) -> Iterator[Result]:
    """Start ``work`` in a child process; return an iterator of what it yields.

    The iterator raises what ``work`` raises if it can be pickled, and `ChildEndedError` for the rest and if a limit is
    reached. Without it, the child ends.
    """
    results = _results(work, limits)
    next(results)
    return results


def _results(work: Callable[[], Iterable[Any]], limits: Limits) -> Iterator[Any]:
    """Yield None when the child process has started, and then what ``work`` yields."""
    fork = multiprocessing.get_context("fork")  # the child has the catalogue, and all that the parent has read
    receiver, sender = fork.Pipe(duplex=False)
    with contextlib.suppress(AttributeError, OSError):  # else the child may wait until somebody reads
        fcntl.fcntl(sender.fileno(), fcntl.F_SETPIPE_SZ, _PIPE)
    with tempfile.TemporaryDirectory(prefix="check-launch-") as folder, receiver:
        child = fork.Process(target=_child, args=(work, sender, receiver, folder, limits), daemon=True)
        with warnings.catch_warnings():
            # Python 3.12 warns of locks that other threads hold. The child takes none of theirs.
            warnings.simplefilter("ignore", DeprecationWarning)
            child.start()
        pid = cast(int, child.pid)  # it has been started
        sender.close()
        try:
            yield None
            while True:
                _wait(receiver, pid, limits.seconds)
                try:
                    data = receiver.recv_bytes(_LARGEST_RESULT)
                except (EOFError, OSError):
                    child.join(limits.seconds)
                    raise ChildEndedError(_reason(child.exitcode)) from None
                if not data:
                    return
                yield _result(data)
        finally:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(pid, signal.SIGKILL)  # the group: also what the child has started
            child.kill()  # it may not have its own group yet
            child.join()


def _wait(receiver: Connection, pid: int, most: float) -> None:
    """Wait for the next result. Raises `ChildEndedError` if the child takes too long.

    Processor time decides, so that a computer gives the same answer whatever else it does. A child that only waits
    uses none.
    """
    # Most results come before the first look, and to look at all processes takes milliseconds.
    begin, _ = _use(pid, [_PROCESSES / f"{pid}/stat"])
    last, since = begin, time.monotonic()
    while not receiver.poll(min(_LOOK, most)):
        now, is_ready = _use(pid, _PROCESSES.glob("[0-9]*/stat"))
        if now != last or is_ready:
            last, since = now, time.monotonic()
        if now - begin > most:
            raise ChildEndedError(f"it takes longer than {most:g} s")
        if time.monotonic() - since > most:
            raise ChildWaitsError(f"it waits longer than {most:g} s")


def _use(group: int, files: Iterable[Path]) -> tuple[float, bool]:
    """Return the seconds of processor time of those of some processes that are of a group, and if one could go on.

    It is 0 and false if the system does not tell.
    """
    ticks, is_ready = 0, False
    for file in files:
        with contextlib.suppress(OSError):  # it has ended meanwhile
            words = file.read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()
            if int(words[2]) == group:
                ticks += sum(map(int, words[11:15]))  # utime to cstime (proc_pid_stat(5))
                is_ready |= words[0] in "RD"  # others use the processor or the disk
    return ticks / os.sysconf("SC_CLK_TCK"), is_ready


def _result(data: bytes) -> Any:
    """Return a result of the child, or raise its error."""
    try:
        found = pickle.loads(data)  # noqa: S301  # the child has the rights of the user, with or without pickle
    except Exception as error:  # a class of the launch file, which the parent does not have
        raise ChildEndedError(f"its result cannot be read: {error}") from error
    if isinstance(found, Exception):
        raise found
    return found


def _reason(code: int | None) -> str:
    if code is None:
        return "it closed its connection to the check"
    if code < 0:
        return f"it was ended by {signal.Signals(-code).name}"
    return f"it ended the process with exit code {code}"


def _child(
    work: Callable[[], Iterable[Result]], sender: Connection, receiver: Connection, folder: str, limits: Limits
) -> None:
    """Do the work and send its results. Ends the process, also if threads of the work still run."""
    receiver.close()  # so that sending fails if the parent has been killed, and this process ends, too
    os.setsid()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)  # the handlers of the command would raise in the launch file
    os.chdir(folder)
    os.environ["TMPDIR"] = tempfile.tempdir = folder
    null = os.open(os.devnull, os.O_RDWR)
    for descriptor in range(3):
        os.dup2(null, descriptor)
    sys.stdin, sys.stdout, sys.stderr = (open(os.devnull, mode, encoding="utf-8") for mode in "rww")  # noqa: SIM115
    _limit(limits)
    status, end = 1, os._exit  # a launch file may replace the function in its module
    try:
        for result in work():
            sender.send_bytes(pickle.dumps(result))
        sender.send_bytes(b"")
        status = 0
    except BaseException as error:  # noqa: BLE001  # whatever it is, the parent reports it
        sender.send_bytes(_pickled(error))
    finally:
        end(status)


def _pickled(error: BaseException) -> bytes:
    """Return an error for the parent; one that it could not read, or that is none of ours, as a text."""
    if type(error).__module__.startswith("check_launch."):
        with contextlib.suppress(Exception):
            return pickle.dumps(error)
    return pickle.dumps(ChildEndedError(f"{type(error).__name__}: {error}"))


def _limit(limits: Limits) -> None:
    """Set the limits of this process."""
    used = _address_space()
    for kind, most in (
        (resource.RLIMIT_AS, used + limits.memory if used else resource.RLIM_INFINITY),
        (resource.RLIMIT_FSIZE, limits.file_size),
        (resource.RLIMIT_CORE, 0),
    ):
        _, highest = resource.getrlimit(kind)
        with contextlib.suppress(ValueError, OSError):  # above the highest one, or not limited on this system
            resource.setrlimit(kind, (most, highest))
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # so that writing fails instead (setrlimit(2))


def _address_space() -> int:
    """Return the bytes of the address space that this process uses; 0 if the system does not tell."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError):
        return 0
