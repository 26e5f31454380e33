"""What the tests of the runtime share."""

from __future__ import annotations

import pytest

from generated.registry import REGISTRY
from roverlink.runtime import Registry, Translator


@pytest.fixture(scope="session")
def registry() -> Registry:
    """The registry of this repository's own table."""
    return REGISTRY


@pytest.fixture(scope="session")
def translator(registry: Registry) -> Translator:
    """The core over that registry."""
    return Translator(registry)
