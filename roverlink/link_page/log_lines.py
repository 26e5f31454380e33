"""Last lines of a log, for a page."""

from __future__ import annotations

import logging
import threading
from collections import deque
from typing import Any

_KEPT = 200
_LONGEST = 1000  # characters


class LogLines:
    """Last lines of a log, each with a growing number. Safe to use from several threads."""

    def __init__(self) -> None:
        self._lines: deque[dict[str, Any]] = deque(maxlen=_KEPT)
        self._lock = threading.Lock()
        self._number = 0

    def add(self, time: float, level: int, text: str) -> None:
        """Add a line; ``time`` is in seconds since 1970, ``level`` is a level of `logging`."""
        with self._lock:
            self._number += 1
            line = {"number": self._number, "time": time, "level": logging.getLevelName(level), "text": text[:_LONGEST]}
            self._lines.append(line)

    def after(self, number: int) -> list[dict[str, Any]]:
        """Return the lines whose numbers are greater than ``number``, oldest first."""
        with self._lock:
            return [line for line in self._lines if line["number"] > number]


class LogLinesHandler(logging.Handler):
    """Log handler that adds the records of a logger to `LogLines`, until it is closed."""

    def __init__(self, logger: logging.Logger, lines: LogLines) -> None:
        super().__init__()
        self._logger, self._to = logger, lines
        logger.addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Add a record; `logging` calls this."""
        self._to.add(record.created, record.levelno, record.getMessage())

    def close(self) -> None:
        """Remove this handler from the logger."""
        self._logger.removeHandler(self)
        super().close()
