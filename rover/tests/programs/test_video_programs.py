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
from polling import PATIENCE_S, wait_until
from programs import Program, Start

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)
pytest.importorskip("av", reason=NO_AV)

pytestmark = pytest.mark.slow

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


_PIPELINE = (  # the rover's earlier pipeline, and the two options that a late receiver needs
    "videotestsrc is-live=true ! video/x-raw,width=320,height=240,framerate=30/1 ! videoconvert ! "
    "x264enc tune=zerolatency speed-preset=superfast key-int-max=30 ! rtph264pay pt=96 config-interval=1 ! "
    "udpsink host=127.0.0.1 port={port}"
)
_FILM = "-re -f lavfi -i testsrc2=size=320x240:rate=30 -c:v libx264 -tune zerolatency -g 30"


@pytest.mark.parametrize(
    ("package", "line"),
    [
        ("gstreamer1.0-tools", f"gst-launch-1.0 -q {_PIPELINE}"),
        ("ffmpeg", f"ffmpeg -loglevel error {_FILM} -f rtp rtp://127.0.0.1:{{port}}"),  # it packs as it does by default
    ],
)
def test_our_receiver_shows_what_others_send(receiver: tuple[Program, int], package: str, line: str) -> None:
    """The images of GStreamer and of FFmpeg come whole and in time."""
    words = line.format(port=receiver[1]).split()
    _needs(words[0], package)
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL) as process:
        _wait_for_images(receiver[0])
        process.terminate()


def _wait_for_images(receiver: Program) -> None:
    def intact() -> bool:
        states = [json.loads(line)["streams"][0] for line in list(receiver.output)]
        return any(state["rate"] > 10 and state["intact"] == 1 and state["size"] == [320, 240] for state in states)

    wait_until(intact, "intact images")


_PLAYER = (  # the pipeline of the basestation, which joins late
    f"udpsrc port={{port}} caps={_CAPS} ! rtpjitterbuffer latency=50 ! rtph264depay ! avdec_h264 ! videoconvert ! "
    f"video/x-raw,format=GRAY8 ! identity eos-after={_IMAGES} ! filesink location=images.raw"
)
_SINK = f"-frames:v {_IMAGES} -pix_fmt gray -f rawvideo images.raw"


@pytest.mark.parametrize(
    ("package", "line"),
    [
        ("gstreamer1.0-tools", f"gst-launch-1.0 -q {_PLAYER}"),
        ("ffmpeg", f"ffmpeg -loglevel error -protocol_whitelist file,rtp,udp -i front.sdp {_SINK}"),
    ],
)
def test_others_show_what_we_send(sender: Program, port: int, tmp_path: Path, package: str, line: str) -> None:
    """GStreamer by its pipeline, FFmpeg from a description of the stream (SDP)."""
    words = line.format(port=port).split()
    _needs(words[0], package)
    (tmp_path / "front.sdp").write_text(_SDP.format(port=port))
    subprocess.run(words, check=True, timeout=PATIENCE_S, stdin=subprocess.DEVNULL, cwd=tmp_path)
    images = np.frombuffer((tmp_path / "images.raw").read_bytes(), np.uint8)
    assert images.size >= (_IMAGES - 1) * 320 * 240
    middle = images[: images.size // (320 * 240) * 320 * 240].reshape(-1, 240, 320)[:, 120, 160]
    assert (np.abs(middle.astype(int) - 125) < 12).all()
    assert sender.interrupt() == 0


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
