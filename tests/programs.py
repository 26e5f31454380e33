"""The command line as a program of its own."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from polling import PATIENCE_S, wait_until


class Program:
    """A running roverlink. Its standard error is read as it comes; so is its standard output, line by line."""

    def __init__(self, arguments: tuple[object, ...], environment: dict[str, str], folder: Path) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "roverlink", *map(str, arguments)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=environment,
            cwd=folder,
        )
        self.output: list[str] = []
        self.errors: list[str] = []
        self._readers = [
            threading.Thread(target=self._read, args=(stream, lines), daemon=True)
            for stream, lines in ((self._process.stdout, self.output), (self._process.stderr, self.errors))
        ]
        for reader in self._readers:
            reader.start()

    @property
    def pid(self) -> int:
        """The number of its process."""
        return self._process.pid

    @staticmethod
    def _read(stream: object, lines: list[str]) -> None:
        for line in stream:  # type: ignore[attr-defined]  # a pipe, as it was asked for
            lines.append(line.rstrip("\n"))  # each line is seen as soon as it is there

    def wait_for(self, text: str, lines: list[str] | None = None) -> str:
        """The first line of its standard error, or of other lines of its, that has a text in it."""
        where = self.errors if lines is None else lines

        def line_with_text() -> str | None:
            if ended := self._process.poll() is not None:
                self._join()
            found = next((line for line in list(where) if text in line), None)
            assert found or not ended, f"ended with {self._process.returncode} and no {text!r}:\n{self}"
            return found

        return wait_until(line_with_text, repr(text)) or ""

    def send_signal(self, number: signal.Signals) -> None:
        """Send it a signal."""
        self._process.send_signal(number)

    def end(self) -> int:
        """Wait until it has ended; its exit code. No program of ours ends with a traceback."""
        code = self._wait()
        self._join()
        assert "Traceback" not in str(self), str(self)
        return code

    def _wait(self) -> int:
        """Its exit code; where it hangs, the test fails with what each of its threads is doing."""
        try:
            return self._process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            self.send_signal(signal.SIGABRT)
            self._process.wait()
            self._join()
            pytest.fail(f"it has not ended after {PATIENCE_S:.0f} s:\n{self}")

    def interrupt(self, number: signal.Signals = signal.SIGINT) -> int:
        """Stop it as an operator does; its exit code."""
        self.send_signal(number)
        code = self._wait()
        return self.end() if code == 0 else code

    def _join(self) -> None:
        for reader in self._readers:
            reader.join(PATIENCE_S)

    def kill(self) -> None:
        """End it, whatever it does."""
        self._process.kill()
        self._process.wait()
        self._join()
        for stream in (self._process.stdout, self._process.stderr):
            if stream is not None:
                stream.close()

    def __str__(self) -> str:
        return "\n".join([*self.output, *self.errors])


Start = Callable[..., Program]
