"""Command line of the benchmarks of video: python -m rover.bench.video."""

from __future__ import annotations

import argparse
import itertools
import json
import os
import shutil
import socket
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO, Any, cast

from rich.console import Console
from roverkit.vision.images.film import Film

from bench.errors import BenchError
from bench.report import report
from bench.result import Group, SectionResult, Table
from rover.bench.video.numbered_film import draw_scenes, film
from rover.bench.video.radio_link import HOST, RadioLink
from roverlink.runtime.core.errors import SetupError

_TOOLS = (sys.executable, "-m", "rover.bench.video.tools")
_KINDS = ("roverlink", "gstreamer")
NATIVE = "gstreamer alone"
_SIZES = ((640, 480), (1280, 720))
_WARM_S = 20.0
"""Time in seconds that a receiver waits for the sender, which reads its film first."""
_LINK = 4e6
_COMMAND_S = 0.02
SECTIONS = ("latency", "losses", "joining", "commands", "long")


@dataclass(frozen=True, slots=True)
class Run:
    """Result of a sender with a receiver. Times are in milliseconds and CPU in percent of a core."""

    sent: int
    shown: int
    intact: int | None
    """Images that were intact; None for GStreamer, which does not tell it."""
    latencies: list[float]
    """Times from the encoder to after the decoder, sorted."""
    gap: float
    sender: float
    receiver: float


def run(
    sender: str, receiver: str, seconds: float, *, link: RadioLink | None = None, port: int = 4600, **options: Any
) -> Run:
    """Send for some seconds, and receive; with a link, through it."""
    with started(receiver, port, seconds, **options) as finish:
        sent = _answer(_popen("send", sender, link.ports[0] if link else port, seconds, **options))
        return result(sent, finish(), seconds)


@contextmanager
def started(kind: str, port: int, seconds: float, **options: Any) -> Iterator[Callable[[], dict[str, Any]]]:
    """Start a receiver; the value is a function that waits for its end and returns its answer."""
    size = {key: value for key, value in options.items() if key == "size"}
    process = _popen("receive", kind, port, seconds + _WARM_S, **size)
    cast("IO[str]", process.stdout).readline()  # it listens
    try:
        yield lambda: _answer(process)
    finally:
        process.kill()
        process.wait()


def result(sent: dict[str, Any], received: dict[str, Any], seconds: float) -> Run:
    """Return the result of a sender and a receiver from their answers."""
    out, back = sent["times"], received["times"]
    latencies = sorted((back[key] - out[key]) / 1e6 for key in back if key in out)
    arrived = sorted(back.values())
    gap = max(((after - before) / 1e6 for before, after in itertools.pairwise(arrived)), default=0.0)
    intact = len(received["intact"]) if received["intact"] or not back else None
    cpu = [100 * one["cpu"] / seconds for one in (sent, received)]
    return Run(len(out), len(latencies), intact, latencies, gap, *cpu)


def latency(seconds: float, say: Callable[[str], None]) -> SectionResult:
    """Measure the latency and the CPU of all pairs of senders and receivers."""
    groups, data = [], []
    for size in _SIZES:
        rows = []
        for sender, receiver in (("gstreamer",) * 2, ("roverlink",) * 2, _KINDS, _KINDS[::-1]):
            say(f"latency: {sender} to {receiver}, {size[0]}x{size[1]}")
            one = run(sender, receiver, seconds, size=size)
            numbers = _part(one.latencies, 0.5), _part(one.latencies, 0.95), one.sender, one.receiver
            rows.append((f"{sender} to {receiver}", *(f"{number:.1f}" for number in numbers)))
            say("  median {} ms, p95 {} ms, sender {} %, receiver {} %".format(*rows[-1][1:]))
            data.append(
                {"sender": sender, "receiver": receiver, "size": size}
                | dict(zip(("median_ms", "p95_ms", "sender_percent", "receiver_percent"), numbers))
            )
        say(f"latency: GStreamer alone, {size[0]}x{size[1]}")
        native = 100 * _answer(_popen("native", "gstreamer", 4600, seconds, size=size))["cpu"] / seconds
        rows.append((NATIVE, "–", "–", f"{native:.1f}", "–"))
        say(f"  sender {native:.1f} %")
        data.append({"sender": NATIVE, "size": size, "sender_percent": native})
        groups.append(Group("{}x{} at 30 Hz, 2 Mbit/s".format(*size), rows))
    columns = ("from encoder to decoder", "median\nms", "p95\nms", "sender\n% of a core", "receiver\n% of a core")
    notes = [
        "Goals: at most 1.5 times the latency of GStreamer to GStreamer, and 1.2 times the CPU of GStreamer alone.",
        "GStreamer alone reads the images itself. The other pipelines get them from a program through a pipe.",
    ]
    return SectionResult([Table("Latency on loopback", columns, groups, notes)], (), {"pairs": data})


def losses(seconds: float, say: Callable[[str], None]) -> SectionResult:
    """Measure what remains if a link loses packets, in both directions."""
    groups, data = [], []
    for loss in (0.01, 0.05):
        rows = []
        for sender, receiver in (("roverlink",) * 2, _KINDS, _KINDS[::-1], ("gstreamer",) * 2):
            say(f"losses: {sender} to {receiver}, {loss:.0%}")
            with RadioLink([4600], loss=loss) as link:
                one = run(sender, receiver, seconds, link=link, bitrate=1000)
            shown = 100 * one.shown / one.sent
            intact = None if one.intact is None else 100 * one.intact / one.sent
            texts = f"{shown:.0f}", "–" if intact is None else f"{intact:.0f}", f"{one.gap:.0f}"
            rows.append((f"{sender} to {receiver}", *texts))
            data.append(
                {"sender": sender, "receiver": receiver, "loss": loss}
                | {"shown_percent": shown, "intact_percent": intact, "longest_pause_ms": one.gap}
            )
        groups.append(Group(f"{loss:.0%} of the packets lost", rows))
    columns = ("", "shown %", "intact %", "longest pause\nms")
    notes = [
        "Goals: 85 % and 50 % intact, no pause above 1000 ms.",
        "Images whose number is damaged count as not shown.",
    ]
    return SectionResult([Table("Losses, 640x480 at 30 Hz, 1 Mbit/s", columns, groups, notes)], (), {"pairs": data})


def joining(seconds: float, say: Callable[[str], None]) -> SectionResult:
    """Measure how long receivers wait for a picture that join late, and after a restart of the sender."""
    waits = {}
    for receiver in _KINDS:
        say(f"joining: {receiver}")
        waits[f"roverlink to {receiver}, joins late"] = max(_joined(receiver, pause) for pause in (0.0, 0.35, 0.7))
    say("joining: restart of the sender")
    waits["roverlink to roverlink, sender starts again"] = _restarted(seconds)
    rows = [(title, f"{wait:.2f}") for title, wait in waits.items()]
    notes = [
        "Goals: 1 s after joining (of three), 2 s after a restart, both until the decoded picture.",
        "After a restart, the time begins with the first image that the sender encodes.",
    ]
    table = Table("First picture", ("", "longest wait\ns"), [Group("640x480 at 30 Hz", rows)], notes)
    return SectionResult([table], (), {"longest_waits_s": waits})


def _joined(receiver: str, pause: float) -> float:
    sender = _popen("send", "roverlink", 4600, _WARM_S + 5)
    try:
        cast("IO[str]", sender.stdout).readline()  # it sends
        time.sleep(1.5 + pause)
        with started(receiver, 4600, 5 - _WARM_S) as finish:
            return float(finish()["first"])
    finally:
        sender.kill()
        sender.wait()


def _restarted(seconds: float) -> float:
    with started("roverlink", 4600, 2 * seconds) as finish:
        _answer(_popen("send", "roverlink", 4600, seconds / 2))
        sent = _answer(_popen("send", "roverlink", 4600, seconds / 2, first=10_000))
        received = finish()
    begin = min(sent["times"].values())
    shown = [at for number, at in received["times"].items() if int(number) >= 10_000]
    return (min(shown) - begin) / 1e9 if shown else float("inf")


def commands(seconds: float, say: Callable[[str], None]) -> SectionResult:
    """Measure commands on a link of 4 Mbit/s, beside three streams of 1 Mbit/s."""
    rows, data = [], []
    for name, kind, options in (
        ("no video", "", {}),
        ("three streams of roverlink, link_rate 3600", "roverlink", {"link_rate": 3600}),
        ("three streams of GStreamer", "gstreamer", {}),
    ):
        say(f"commands: {name}")
        times, runs = _commanded(kind, seconds, **options)
        video = max((_part(one.latencies, 0.95) for one in runs), default=0.0)
        shown = f"{video:.0f}" if runs else "–"
        numbers = _part(times, 0.5), _part(times, 0.99), times[-1]
        rows.append((name, *(f"{number:.1f}" for number in numbers), shown))
        data.append({"video": name} | dict(zip(("median_ms", "p99_ms", "longest_ms"), numbers)))
    columns = ("", "median\nms", "p99\nms", "longest\nms", "video, p95\nms")
    notes = ["Goal: p99 at most 5 ms above that without video. The link has one queue for all, without priorities."]
    table = Table("Commands on a link of 4 Mbit/s", columns, [Group("50 Hz", rows)], notes)
    return SectionResult([table], (), {"commands": data})


def _commanded(kind: str, seconds: float, **options: Any) -> tuple[list[float], list[Run]]:
    ports, target = [4600, 4601, 4602], 4610
    times: list[float] = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as end, RadioLink([*ports, target], rate=_LINK) as link:
        end.bind((HOST, target))
        end.settimeout(1.0)
        receivers = [_popen("receive", "roverlink", port, seconds + _WARM_S) for port in ports] if kind else []
        for receiver in receivers:
            cast("IO[str]", receiver.stdout).readline()
        sender = _popen("send", kind, link.ports[:3], seconds + 4, bitrate=1000, **options) if kind else None
        if sender:
            cast("IO[str]", sender.stdout).readline()

        def listen() -> None:
            try:
                while True:
                    begun = float(end.recv(100))
                    times.append(1e3 * (time.monotonic() - begun))
            except TimeoutError:
                return

        listener = threading.Thread(target=listen)
        listener.start()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as begin:
            for _ in range(round(seconds / _COMMAND_S)):
                begin.sendto(b"%.6f" % time.monotonic(), (HOST, link.ports[-1]))
                time.sleep(_COMMAND_S)
        listener.join()
        sent = _answer(sender) if sender else {}
        received = [_answer(one) for one in receivers]
    return sorted(times), [result(sent, one, seconds) for one in received]


def long(seconds: float, say: Callable[[str], None]) -> SectionResult:
    """Watch the memory and the latency of the programs with three streams for a long time."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        with Film(folder / "film.mp4", 30.0) as film_file:
            for number, image in enumerate(film((640, 480), _film_file())):
                film_file.add(image, round(number * 1e9 / 30))
        streams = {f"s{port}": {"source": "film.mp4", "port": port} for port in (4600, 4601, 4602)}
        (folder / "video.yaml").write_text(json.dumps({"host": HOST, "streams": streams}), encoding="utf-8")
        program = (sys.executable, "-m", "roverlink", "video")
        ports = [f"{stream}={keys['port']}" for stream, keys in streams.items()]
        samples: list[tuple[float, float, float]] = []  # MiB of the sender and of the receiver, latency in ms
        with (
            _program([*program, "receive", *ports, "--json", "--no-page"]) as receiver,
            _program([*program, "send", str(folder / "video.yaml"), "--loop", "--middleware", "none"]) as sender,
        ):
            end = time.monotonic() + seconds
            for line in cast("IO[str]", receiver.stdout):
                latencies = [load["latency"] for load in json.loads(line)["streams"]]
                if None not in latencies:
                    samples.append((_memory(sender), _memory(receiver), 1e3 * max(latencies)))
                    if len(samples) % 30 == 0:
                        say(f"long: {len(samples)} s")
                if time.monotonic() > end:
                    break
        quarter = len(samples) // 4
        parts = samples[quarter : 2 * quarter], samples[-quarter:]
        names = "sender, MiB", "receiver, MiB", "latency of the slowest stream, ms"
        medians = {
            name: [statistics.median(one[index] for one in part) for part in parts] for index, name in enumerate(names)
        }
    rows = [(name, *(f"{value:.1f}" for value in values)) for name, values in medians.items()]
    columns = ("median", "second\nquarter", "last\nquarter")
    groups = [Group(f"{len(samples)} s, 640x480 at 30 Hz", rows)]
    table = Table("Three streams for a long time", columns, groups)
    return SectionResult([table], (), {"seconds": len(samples), "medians_of_second_and_last_quarter": medians})


@cache
def _film_folder() -> TemporaryDirectory[str]:
    """Return a folder with the scenes, which is removed at the end of the program."""
    folder = TemporaryDirectory(prefix="roverlink-film-")
    draw_scenes(Path(folder.name) / "scenes.npy")
    return folder


def _film_file() -> Path:
    return Path(_film_folder().name) / "scenes.npy"


@contextmanager
def _program(words: Sequence[str]) -> Iterator[subprocess.Popen[str]]:
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:  # noqa: S603
        try:
            yield process
        finally:
            process.terminate()  # not SIGINT, which a shell's background jobs ignore


def _memory(process: subprocess.Popen[str]) -> float:
    """Return the memory of a process in MiB."""
    pages = int(Path(f"/proc/{process.pid}/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


def _popen(job: str, kind: str, port: int | list[int], seconds: float, **options: Any) -> subprocess.Popen[str]:
    ports = map(str, port if isinstance(port, list) else [port])
    words = [*_TOOLS, job, kind, "--port", *ports, "--seconds", str(seconds), "--film", str(_film_file())]
    for name, value in options.items():
        words += [f"--{name.replace('_', '-')}", *(map(str, value) if isinstance(value, tuple) else (str(value),))]
    return subprocess.Popen(words, stdout=subprocess.PIPE, text=True)  # noqa: S603  # our own program


def _answer(process: subprocess.Popen[str]) -> dict[str, Any]:
    lines = process.communicate()[0].splitlines()
    if process.returncode or not lines:
        raise BenchError(f"a measured program ended with {process.returncode}; its messages are above")
    found: dict[str, Any] = json.loads(lines[-1])
    return found


def _part(values: Sequence[float], part: float) -> float:
    """Return a quantile of sorted values."""
    return values[min(int(part * len(values)), len(values) - 1)] if values else float("inf")


def main(words: Sequence[str]) -> int:
    """Measure, print the tables, and return the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m rover.bench.video",
        description="Measure video on this computer, beside GStreamer.",
        epilog="example: python -m rover.bench.video --only latency losses --seconds 10",
    )
    parser.add_argument(
        "--only", nargs="+", choices=SECTIONS, default=SECTIONS, metavar="NAME", help=", ".join(SECTIONS)
    )
    parser.add_argument("--seconds", type=float, default=20.0, help="seconds for each measurement (default: 20)")
    parser.add_argument("--long", type=float, default=600.0, metavar="S", help="seconds of `long` (default: 600)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the numbers to FILE")
    options = parser.parse_args(words)
    progress = Console(stderr=True, highlight=False, markup=False)
    if set(options.only) != {"long"} and shutil.which("gst-launch-1.0") is None:
        print("gst-launch-1.0 is missing; rover/docs/video.md has the command that installs GStreamer", file=sys.stderr)
        return 2
    measures = {"latency": latency, "losses": losses, "joining": joining, "commands": commands, "long": long}
    results = {}
    try:
        for name in options.only:
            results[name] = measures[name](options.long if name == "long" else options.seconds, progress.print)
    except (BenchError, SetupError) as error:
        print(f"rover.bench.video: {error}", file=sys.stderr)
        return 2
    report(results, options.json)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
