"""A moment of `make soak`, for the sample rover with everything switched on."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import chain
from pathlib import Path
from typing import Any

import pytest
from full_project import write_project

from roverlink.simulation.scenarios import SCENARIOS

Start = Callable[..., Any]


@pytest.mark.slow
def test_everything_adds_up_with_everything_switched_on(done: Start, tmp_path: Path) -> None:
    """Signatures, link messages, a learned address, rate limits and attacks: every datagram is found by its reason."""
    write_project(tmp_path / "rover")
    scenarios = chain.from_iterable(("--scenario", name) for name in reversed(SCENARIOS))
    options = ("--project", tmp_path / "rover", "--bridge", "memory", "--seconds", 10, "--rate", 500, "--json")
    code, output, errors = done("simulate", *options, *scenarios)
    assert code == 0, output + errors
    account = json.loads(output)
    bridge = account["bridge"]
    assert {"replayed", "outdated"} <= bridge["dropped"].keys()  # a slow computer does not get to the rarer ones
    assert bridge["link_events"]["hardware learned"] == 1
    assert bridge["links_received"] > 0
    assert bridge["links_sent"].keys() == {"hardware", "driving", "basestation"}
    assert bridge["forwarded"] > 0
