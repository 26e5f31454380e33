"""A terminal with a keyboard and a screen, in which a command runs."""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import struct
import subprocess
import sys
import termios

from polling import PATIENCE_S, wait_until


class Terminal:
    """A command on a terminal of some size. A context manager."""

    def __init__(self, *arguments: object, columns: int = 80, lines: int = 24, own: bool = True) -> None:
        """Start the command; if ``own`` is false, its session has another terminal, or none."""
        self._master, self._slave = os.openpty()
        fcntl.ioctl(self._slave, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))
        self._before = termios.tcgetattr(self._slave)
        self._screen = ""
        kept = {name: value for name, value in os.environ.items() if name not in ("COLUMNS", "LINES")}

        def own_the_terminal() -> None:
            os.setsid()
            if own:
                fcntl.ioctl(self._slave, termios.TIOCSCTTY, 0)

        self._process = subprocess.Popen(
            [sys.executable, "-m", "roverlink", *map(str, arguments)],
            stdin=self._slave,
            stdout=self._slave,
            stderr=self._slave,
            env={**kept, "TERM": "xterm-256color"},
            preexec_fn=own_the_terminal,
        )

    def type(self, keys: str) -> None:
        """Press keys."""
        os.write(self._master, keys.encode())

    def wait_for(self, pattern: str) -> str:
        """Wait until the screen shows a text after what it showed before; return what came up to its end."""

        def shown() -> re.Match[str] | None:
            with contextlib.suppress(BlockingIOError):
                self._screen += re.sub(r"\x1b\[[0-9;]*m", "", os.read(self._master, 65_536).decode(errors="replace"))
            return re.search(pattern, self._screen)

        found = wait_until(shown, repr(pattern))
        assert found is not None
        text, self._screen = self._screen[: found.end()], self._screen[found.end() :]
        return text

    def end(self) -> int:
        """Wait until the command has ended; its exit code."""
        return self._process.wait(PATIENCE_S)

    def left_as_it_was(self) -> bool:
        """True if the terminal has the settings that it had before the command."""
        return termios.tcgetattr(self._slave) == self._before

    def __enter__(self) -> Terminal:
        os.set_blocking(self._master, False)
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()
        os.close(self._master)
        os.close(self._slave)
