"""Keys that the user presses on the terminal, without the Enter key."""

from __future__ import annotations

import os
import re
import select
import sys
import termios
import time
import tty

_SEQUENCES = {
    "[A": "up",
    "[B": "down",
    "[C": "right",
    "[D": "left",
    "[H": "home",
    "[F": "end",
    "[1~": "home",
    "[4~": "end",
    "[7~": "home",
    "[8~": "end",
    "[5~": "page up",
    "[6~": "page down",
    "[Z": "back tab",
}
_CHARACTERS = {"\t": "tab", "\r": "enter", "\n": "enter", "\x7f": "backspace", "\x08": "backspace", "\x1b": "escape"}
# A terminal sends ESC [ or ESC O with parameters and a final character for a key that is no character (ECMA-48, 5.4).
_KEY = re.compile(r"\x1b[\[O][0-9;]*[@-~]|.", re.DOTALL)
_UNFINISHED = re.compile(r"\x1b([\[O][0-9;]*)?\Z")
_REST_S = 0.05  # a slow connection may split the characters of one key


class Keyboard:
    """Keyboard of the terminal on standard input. A context manager; on exit the terminal is as it was before.

    If standard input is not a terminal, no key is ever pressed.
    """

    def __init__(self) -> None:
        self._terminal: int | None = None
        try:
            if os.isatty(sys.stdin.fileno()):
                self._terminal = sys.stdin.fileno()
        except (AttributeError, OSError, ValueError):  # standard input is closed or replaced
            pass
        self._before = None if self._terminal is None else termios.tcgetattr(self._terminal)

    @property
    def available(self) -> bool:
        """True if standard input is a terminal and this command runs in its foreground."""
        # Linux stops a background process that reads from its terminal or changes it (termios(3), TOSTOP).
        try:
            return self._terminal is not None and os.tcgetpgrp(self._terminal) == os.getpgrp()
        except OSError:  # the terminal is that of another session (setsid), or was closed
            return False

    def __enter__(self) -> Keyboard:
        return self

    def __exit__(self, *_: object) -> None:
        if self._terminal is not None and self._before is not None and self.available:
            termios.tcsetattr(self._terminal, termios.TCSADRAIN, self._before)

    def keys(self, seconds: float) -> list[str]:
        """Return the keys pressed within ``seconds`` seconds; return at once after the first one.

        A key is a character, or a name such as ``up``, ``page down``, ``tab`` or ``escape``.
        """
        text = self._read(seconds)
        while text and _UNFINISHED.search(text) and (rest := self._read(_REST_S)):
            text += rest
        return [key for key in map(_name, _KEY.findall(text)) if key]

    def _read(self, seconds: float) -> str:
        if self._terminal is None or not self.available:
            time.sleep(seconds)
            return ""
        # Checked each time: a shell resets the terminal when it stops and continues a command (Ctrl-Z, `fg`).
        if termios.tcgetattr(self._terminal)[3] & termios.ICANON:
            tty.setcbreak(self._terminal, termios.TCSADRAIN)  # not raw: Ctrl-C must still interrupt
        if not select.select([self._terminal], [], [], seconds)[0]:
            return ""
        data = os.read(self._terminal, 1024)
        if not data:  # the terminal was closed
            self._terminal = None
        return data.decode(errors="replace")


def _name(keys: str) -> str:
    """Return the name of a key from the characters that the terminal sends for it; empty for an unknown key."""
    if len(keys) > 1:
        return _SEQUENCES.get(f"[{keys[2:]}", "")
    return _CHARACTERS.get(keys, keys if keys.isprintable() else "")
