"""Waiting for what happens elsewhere, without guessing how long it takes."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

PATIENCE_S = 600.0
"""Far longer than anything takes, also on a virtual machine whose busy host lets it stand still for some minutes."""

T = TypeVar("T")


def wait_until(condition: Callable[[], T], what: str, patience_s: float = PATIENCE_S) -> T:
    """Wait until a condition holds, and return what it gave; fail with ``what`` where it never does."""
    deadline = time.monotonic() + patience_s
    while not (found := condition()):
        assert time.monotonic() < deadline, f"after {patience_s:.0f} s still waiting for {what}"
        time.sleep(0.005)
    return found
