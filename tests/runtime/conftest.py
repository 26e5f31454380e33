"""What the tests of the runtime share."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, settings

from generated.registry import REGISTRY
from roverlink.runtime import Registry, Translator

# A loaded machine says nothing about the code: no property has a deadline.
settings.register_profile("roverlink", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("roverlink")


@pytest.fixture(scope="session")
def registry() -> Registry:
    """The registry of this repository's own table."""
    return REGISTRY


@pytest.fixture(scope="session")
def translator(registry: Registry) -> Translator:
    """The core over that registry."""
    return Translator(registry)
