"""Waiting for what happens elsewhere, without guessing how long it takes."""

from __future__ import annotations

import time
from collections.abc import Callable

PATIENCE_S = 30.0
"""Far longer than anything takes, on a machine that is busy with other things."""


def wait_until(condition: Callable[[], object], what: str) -> None:
    """Wait until a condition holds; fail with ``what`` where it never does."""
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline, f"after {PATIENCE_S:.0f} s still waiting for {what}"
        time.sleep(0.005)
