"""A browser for a test, which is skipped where there is none."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import pytest

from bench.errors import BenchError
from rover.bench.vision.browser import Visitor, browser


@contextmanager
def visiting() -> Iterator[Visitor]:
    """Somebody at a browser."""
    with ExitStack() as stack:
        try:
            visitor = stack.enter_context(browser())
        except BenchError as error:
            pytest.skip(str(error))
        yield visitor
