"""Video to and from GStreamer and FFmpeg, which know nothing of roverlink."""

from __future__ import annotations

import contextlib
import json
import shutil
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from needs import NO_AV, NO_OPENCV
from polling import wait_until
from programs import Program, Start

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)
pytest.importorskip("av", reason=NO_AV)

_CAPS = "application/x-rtp,media=video,encoding-name=H264,payload=96"
_IMAGES = 20
_SDP = """v=0
o=- 0 0 IN IP4 127.0.0.1
s=front
c=IN IP4 127.0.0.1
t=0 0
m=video {port} RTP/AVP 96
a=rtpmap:96 H264/90000
"""


def _needs(program: str, package: str) -> None:
    if shutil.which(program) is None:
        pytest.skip(f"need {program} (apt-get install {package})")


@pytest.fixture
def port() -> Iterator[int]:
    """A UDP port for another program, and one above it, which FFmpeg uses, too.

    It is below those that the kernel gives away, and the TCP port of the same number, which we hold, is the lock.
    """
    with contextlib.ExitStack() as held:
        yield next(number for number in range(6200, 7300, 2) if _claimed(number, held))


def _claimed(number: int, held: contextlib.ExitStack) -> bool:
    try:
        held.enter_context(socket.create_server(("127.0.0.1", number)))
        for udp in (number, number + 1):
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
                sock.bind(("", udp))
    except OSError:
        return False
    return True


@pytest.fixture
def sender(start: Start, tmp_path: Path, port: int) -> Program:
    """Our sender, with grey images."""
    folder = tmp_path / "images"
    folder.mkdir()
    for number in range(10):
        cv2.imwrite(str(folder / f"{number}.png"), np.full((240, 320, 3), 120 + number, np.uint8))
    return start("video", "send", folder, "--port", port, "--loop", "--middleware", "none")


@pytest.fixture
def receiver(start: Start) -> tuple[Program, int]:
    """Our receiver, and its port."""
    program = start("video", "receive", "front=0", "--json", "--page", "0")
    program.wait_for("page: ")
    return program, json.loads(program.wait_for("port", program.output))["streams"][0]["port"]


def test_our_receiver_shows_what_gstreamer_sends(receiver: tuple[Program, int]) -> None:
    """With the rover's earlier pipeline and the two options that a late receiver needs."""
    _needs("gst-launch-1.0", "gstreamer1.0-tools")
    pipeline = (
        "videotestsrc is-live=true ! video/x-raw,width=320,height=240,framerate=30/1 ! videoconvert ! "
        "x264enc tune=zerolatency speed-preset=superfast key-int-max=30 ! rtph264pay pt=96 config-interval=1 ! "
        f"udpsink host=127.0.0.1 port={receiver[1]}"
    )
    with subprocess.Popen(["gst-launch-1.0", "-q", *pipeline.split()]) as process:
        _wait_for_images(receiver[0])
        process.terminate()


def test_our_receiver_shows_what_ffmpeg_sends(receiver: tuple[Program, int]) -> None:
    """As it packs H.264 by default."""
    _needs("ffmpeg", "ffmpeg")
    film = "-re -f lavfi -i testsrc2=size=320x240:rate=30 -c:v libx264 -tune zerolatency -g 30"
    words = ["ffmpeg", "-loglevel", "error", *film.split(), "-f", "rtp", f"rtp://127.0.0.1:{receiver[1]}"]
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL) as process:
        _wait_for_images(receiver[0])
        process.terminate()


def _wait_for_images(receiver: Program) -> None:
    def intact() -> bool:
        states = [json.loads(line)["streams"][0] for line in list(receiver.output)]
        return any(state["rate"] > 10 and state["intact"] == 1 and state["size"] == [320, 240] for state in states)

    wait_until(intact, "intact images")


def test_gstreamer_shows_what_we_send(sender: Program, port: int, tmp_path: Path) -> None:
    """With the pipeline of the basestation, which joins late."""
    _needs("gst-launch-1.0", "gstreamer1.0-tools")
    pipeline = (
        f"udpsrc port={port} caps={_CAPS} ! rtpjitterbuffer latency=50 ! rtph264depay ! avdec_h264 ! videoconvert ! "
        f"video/x-raw,format=GRAY8 ! identity eos-after={_IMAGES} ! filesink location={tmp_path / 'images.raw'}"
    )
    subprocess.run(["gst-launch-1.0", "-q", *pipeline.split()], check=True, timeout=60)
    _check(tmp_path / "images.raw")
    assert sender.interrupt() == 0


def test_ffmpeg_shows_what_we_send(sender: Program, port: int, tmp_path: Path) -> None:
    """From a description of the stream (SDP)."""
    _needs("ffmpeg", "ffmpeg")
    (tmp_path / "front.sdp").write_text(_SDP.format(port=port))
    source = ["-protocol_whitelist", "file,rtp,udp", "-i", str(tmp_path / "front.sdp")]
    sink = ["-frames:v", str(_IMAGES), "-pix_fmt", "gray", "-f", "rawvideo", str(tmp_path / "images.raw")]
    subprocess.run(["ffmpeg", "-loglevel", "error", *source, *sink], check=True, timeout=60, stdin=subprocess.DEVNULL)
    _check(tmp_path / "images.raw")
    assert sender.interrupt() == 0


def _check(path: Path) -> None:
    images = np.frombuffer(path.read_bytes(), np.uint8)
    assert images.size >= (_IMAGES - 1) * 320 * 240
    middle = images[: images.size // (320 * 240) * 320 * 240].reshape(-1, 240, 320)[:, 120, 160]
    assert (np.abs(middle.astype(int) - 125) < 12).all()


@pytest.mark.slow
def test_gstreamer_encodes_our_images(start: Start, tmp_path: Path, receiver: tuple[Program, int]) -> None:
    """With the rover's earlier pipeline, by its name; it ends with the sender."""
    _needs("gst-launch-1.0", "gstreamer1.0-tools")
    cv2.imwrite(str(tmp_path / "0.png"), np.full((240, 320, 3), 120, np.uint8))
    options = ("--port", receiver[1], "--loop", "--pipeline", "legacy", "--middleware", "none")
    sender = start("video", "send", tmp_path, *options)
    _wait_for_images(receiver[0])
    assert sender.interrupt() == 0


def test_a_pipeline_that_fails_is_told(start: Start, tmp_path: Path) -> None:
    """An element that does not exist at the start; a pipeline that ends, when it does."""
    _needs("gst-launch-1.0", "gstreamer1.0-tools")
    cv2.imwrite(str(tmp_path / "0.png"), np.full((240, 320, 3), 120, np.uint8))
    words = ("video", "send", tmp_path, "--loop", "--middleware", "none", "--pipeline")
    program = start(*words, "videoconvert ! nosuchelement ! fakesink")
    program.wait_for("roverlink: GStreamer has no element 'nosuchelement'; check the pipeline, or run `apt-get install")
    assert program.end() == 2
    program = start(*words, "videoconvert ! video/x-raw,format=NONSENSE ! fakesink")
    program.wait_for("video: the pipeline has ended: ")
    assert program.interrupt() == 0
