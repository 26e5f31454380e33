"""Programs that the benchmarks of video start: senders and receivers, ours and those of GStreamer.

Each prints one line of JSON at its end: for each number of an image, the time (monotonic, in nanoseconds) at which it
was given to the encoder, or came out of the decoder; and the CPU time in seconds.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import threading
import time
from contextlib import ExitStack
from pathlib import Path
from string import Template
from tempfile import TemporaryDirectory
from typing import IO, cast

import numpy as np
from roverkit.video.decoder import Decoder
from roverkit.video.gstreamer_output import GStreamerOutput
from roverkit.video.packet_pacing import PacedLink
from roverkit.video.rtp_receiver import RtpReceiver
from roverkit.video.stream_settings import StreamSettings
from roverkit.video.video_output import RtpOutput, VideoOutput

from rover.bench.video.numbered_film import film, number_of, numbered

HOST = "127.0.0.1"
GSTREAMER = (
    "videoconvert ! video/x-raw,format=I420 ! x264enc tune=zerolatency speed-preset=superfast bitrate=$bitrate "
    "key-int-max=30 ! rtph264pay pt=96 config-interval=1 ! udpsink host=$host port=$port sync=false"
)
"""GStreamer's part of the comparison: the rover's pipeline, with the key frames that a late receiver needs."""
_SOURCE = (
    "multifilesrc location={file} loop=true ! rawvideoparse format=bgr width={width} height={height} "
    "framerate={rate}/1 ! clocksync ! "
)
"""Source of a pipeline that no program feeds: it reads the images of the film from memory (the cache of the file)."""
_STARTED_S = 3.0
_RECEIVER = (
    "udpsrc port={port} caps=application/x-rtp,media=video,encoding-name=H264,payload=96 ! "
    "rtpjitterbuffer latency=50 ! rtph264depay ! avdec_h264 ! videoconvert ! video/x-raw,format=BGR ! "
    "fdsink fd=1 sync=false"
)
"""The basestation's pipeline; the images do not wait for their time, so only the work is measured."""


def send(options: argparse.Namespace) -> None:
    """Send the film for some seconds, to each port."""
    settings = StreamSettings(
        "bench",
        "film",
        HOST,
        size=options.size,
        rate=options.rate,
        bitrate=options.bitrate,
        pipeline=GSTREAMER if options.kind == "gstreamer" else "",
    )
    images = film(options.size, options.film)
    times: dict[int, int] = {}
    with ExitStack() as stack:
        link = stack.enter_context(PacedLink(1e3 * options.link_rate))
        outputs: list[VideoOutput] = [
            GStreamerOutput(settings, (HOST, port)) if settings.pipeline else RtpOutput(settings, (HOST, port), link)
            for port in options.port
        ]
        for output in outputs:
            stack.enter_context(output)
        print("ready", flush=True)
        begin, used = time.monotonic(), time.process_time()
        feeding = 0.0
        for index in range(round(options.seconds * options.rate)):
            number = options.first + index
            time.sleep(max(begin + index / options.rate - time.monotonic(), 0))
            before = time.thread_time()
            image = numbered(images, number)
            feeding += time.thread_time() - before
            times[number] = time.monotonic_ns()
            for output in outputs:
                output.put(image, time.time_ns())
        own = time.process_time() - used - feeding
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    # Writing to the pipe is what any program would do to use GStreamer, so it counts, too.
    cpu = own + (children.ru_utime + children.ru_stime if settings.pipeline else 0)
    print(json.dumps({"times": times, "cpu": cpu}))


def native(options: argparse.Namespace) -> None:
    """Let GStreamer send the film without a program that feeds it, and measure its CPU after its start."""
    images, (width, height) = film(options.size, options.film), options.size
    values = {"host": HOST, "port": options.port[0], "bitrate": round(options.bitrate)}
    with TemporaryDirectory() as folder:
        file = Path(folder) / "film.bgr"
        file.write_bytes(b"".join(numbered(images, number).tobytes() for number in range(len(images))))
        source = _SOURCE.format(file=file, width=width, height=height, rate=round(options.rate))
        words = ["gst-launch-1.0", "-q", *(source + Template(GSTREAMER).substitute(values)).split()]
        with subprocess.Popen(words) as process:  # noqa: S603  # our own pipeline
            time.sleep(_STARTED_S)
            used = _cpu(process)
            time.sleep(options.seconds)
            cpu = _cpu(process) - used
            process.terminate()
    print(json.dumps({"times": {}, "cpu": cpu}))


def _cpu(process: subprocess.Popen[bytes]) -> float:
    """Return the CPU time of a process in seconds. Raises `RuntimeError` if it has ended."""
    if process.poll() is not None:
        raise RuntimeError("GStreamer has ended")
    fields = Path(f"/proc/{process.pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def receive(options: argparse.Namespace) -> None:
    """Receive for some seconds."""
    times: dict[int, int] = {}
    intact: list[int] = []
    first = 0
    begin = time.monotonic_ns()
    if options.kind == "gstreamer":
        times, cpu = _gstreamer(options)
    else:
        with RtpReceiver(HOST, options.port[0]) as receiver:
            print("ready", flush=True)
            decoder, end, used = Decoder(), time.monotonic() + options.seconds, time.process_time()
            for unit in receiver.units():
                if time.monotonic() > end:
                    break
                if unit is None:
                    continue
                image = decoder.decode(unit.nals)
                if image is not None:
                    number = number_of(image)
                    times.setdefault(number, time.monotonic_ns())
                    if unit.intact:
                        intact.append(number)
            cpu = time.process_time() - used
    first = min(times.values(), default=0)
    print(json.dumps({"times": times, "intact": intact, "cpu": cpu, "first": (first - begin) / 1e9}))


def _gstreamer(options: argparse.Namespace) -> tuple[dict[int, int], float]:
    width, height = options.size
    words = ["gst-launch-1.0", "-q", *_RECEIVER.format(port=options.port[0]).split()]
    times: dict[int, int] = {}
    with subprocess.Popen(words, stdout=subprocess.PIPE) as process:  # noqa: S603  # our own pipeline
        print("ready", flush=True)
        threading.Timer(options.seconds, process.terminate).start()
        pipe = cast("IO[bytes]", process.stdout)
        while len(data := pipe.read(3 * width * height)) == 3 * width * height:
            now = time.monotonic_ns()
            times.setdefault(number_of(np.frombuffer(data, np.uint8).reshape(height, width, 3)), now)
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return times, children.ru_utime + children.ru_stime


def _arguments(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    parser.add_argument("job", choices=("send", "native", "receive"))
    parser.add_argument("kind", choices=("roverlink", "gstreamer"))
    parser.add_argument("--port", type=int, nargs="+", required=True)
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--first", type=int, default=0, help="number of the first image")
    parser.add_argument("--size", type=int, nargs=2, default=(640, 480))
    parser.add_argument("--rate", type=float, default=30.0)
    parser.add_argument("--bitrate", type=float, default=2000.0)
    parser.add_argument("--link-rate", type=float, default=20_000.0)
    parser.add_argument("--film", type=Path, help="file of draw_scenes, for a sender")
    options = parser.parse_args(words)
    options.size = tuple(options.size)
    return options


if __name__ == "__main__":
    chosen = _arguments(sys.argv[1:])
    {"send": send, "native": native, "receive": receive}[chosen.job](chosen)
