"""Settings of all tests of roverkit."""

import os
from collections.abc import Iterator

import pytest

os.environ.setdefault("JAX_DISABLE_MOST_OPTIMIZATIONS", "1")  # a small network runs sooner than XLA has optimized it


@pytest.fixture(scope="session", autouse=True)
def _compiled_networks(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep what XLA has compiled: tests train the same network several times, and compiling it takes longer."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("JAX_COMPILATION_CACHE_DIR", str(tmp_path_factory.mktemp("compiled")))
        patch.setenv("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0")
        yield
