"""Video stream of the demo's camera: ``roverlink video send`` sends it, and the demo receives it for its page."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import subprocess
import sys
from contextlib import ExitStack

from roverkit.node.camera_outputs import NO_MIDDLEWARE
from roverkit.video.received_stream import ReceivedStream
from roverkit.video.rtp_receiver import RtpReceiver
from roverlink.simulation.demo_parts import DemoPart

_HOST = "127.0.0.1"
_TIMEOUT_S = 20.0


class CameraStream(DemoPart):
    """Stream of a camera. A context manager: the images are sent, decoded and counted inside the block."""

    def __init__(self, images: str) -> None:
        """Prepare to send the images that come from a URL."""
        self._receiver = RtpReceiver(_HOST, 0)
        self.received = ReceivedStream("camera", self._receiver, lambda _: None, lambda *_: None)
        """Stream as it arrives."""
        self._command = [sys.executable, "-m", "roverlink", "video", "send", images, "--overlay", "time"]
        self._command += ["--port", str(self._receiver.port), "--middleware", NO_MIDDLEWARE, "--ros-args"]
        self._command += ["--log-level", "warn"]

    def stop(self) -> str:
        """End the sender, and return a text for the user about the stream."""
        state = self.received.state()
        self._sender.terminate()  # not SIGINT, which a shell's background jobs ignore
        self._sender.wait(_TIMEOUT_S)
        if state["latency"] is None:
            return "no video of the simulated camera arrived"
        return (
            f"the video of the simulated camera arrived with {state['rate']:.0f} images/s, "
            f"{1e3 * state['latency']:.0f} ms after the images were taken"
        )

    def __enter__(self) -> CameraStream:
        with ExitStack() as stack:
            stack.enter_context(self._receiver)
            stack.enter_context(self.received)
            self._sender = subprocess.Popen(self._command)  # noqa: S603  # our own program
            stack.callback(self._kill)
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def _kill(self) -> None:
        if self._sender.poll() is None:
            self._sender.kill()
            self._sender.wait()
