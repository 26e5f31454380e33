"""Camera program of ``roverlink demo``: a child process that reads rendered images, and prints JSON.

It is a process of its own, as on a rover, so its computations do not delay the demo's messages to peers.
"""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any, cast

from roverkit.node.camera_outputs import NO_MIDDLEWARE
from roverlink.runtime import SetupError
from roverlink.runtime.middleware import Middleware
from roverlink.simulation.demo_parts import DemoPart, DemoSetting

_TIMEOUT_S = 20.0


class CameraProgram(DemoPart, ABC):
    """Camera program. A context manager: the child process starts on entry and ends on exit."""

    def __init__(self, setting: DemoSetting, folder: str) -> None:
        """Write the files for the child process into a new folder of the demo, and prepare its command line."""
        self._setting = setting
        (setting.folder / folder).mkdir()
        self._command = [sys.executable, "-m", "roverlink", *self._words(setting.folder / folder), "--json"]
        self._command += ["--middleware", NO_MIDDLEWARE if self._in_memory else setting.middleware]
        self._command += ["--project", str(setting.project), "--ros-args", "--log-level", "warn"]

    @abstractmethod
    def _words(self, folder: Path) -> Sequence[str]:
        """Write the files for the child process into a folder, and return the words of its command line."""

    @abstractmethod
    def _take(self, view: dict[str, Any]) -> None:
        """Take the results of an image, on a thread."""

    @abstractmethod
    def _publish_on(self, middleware: Middleware) -> None:
        """Publish the results of the child process through ``middleware``, which belongs to this process."""

    @property
    def _in_memory(self) -> bool:
        """True if the child process has no access to the topics, because they exist only in this process."""
        return self._setting.middleware == "memory"

    def join(self, middleware: Middleware) -> None:
        """Publish the results of the child process if it cannot publish them itself."""
        if self._in_memory:
            self._publish_on(middleware)

    @property
    @abstractmethod
    def result(self) -> str:
        """Text for the user about what was found."""

    def stop(self) -> str:
        """End the child process, and return `result`."""
        self._child.terminate()  # not SIGINT, which a shell's background jobs ignore
        self._child.wait(_TIMEOUT_S)
        self._thread.join()
        return self.result

    def __enter__(self) -> CameraProgram:
        self._child = subprocess.Popen(  # noqa: S603  # our own program
            self._command, stdout=subprocess.PIPE, text=True
        )
        self._output = cast(IO[str], self._child.stdout)
        first = self._output.readline()
        if not first:
            self._child.wait()
            raise SetupError("a camera program of the demo did not start; see its messages above")
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._child.poll() is None:
            self._child.kill()
            self._child.wait()
        self._output.close()

    def _listen(self) -> None:
        for line in self._output:
            self._take(json.loads(line))
