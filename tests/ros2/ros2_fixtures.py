"""Fixtures of the tests with a real ROS 2, of all products: a judge and a bridge in a DDS domain of each test's own."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from importlib.util import find_spec
from typing import TYPE_CHECKING

import pytest
from needs import NO_DDS, NO_RCLPY
from programs import Start

if TYPE_CHECKING:
    from judge import Bridge, Judge  # importing it skips a module where there is no rclpy


@pytest.fixture
def environment(domain: int, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """The environment of a sourced ROS 2, on this host alone, in a domain that nobody else is in."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    if os.environ.get("ROS_DISTRO") == "humble":  # later ones warn of this variable
        monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.setenv("PYTHONFAULTHANDLER", "1")
    monkeypatch.setenv("COLUMNS", "200")
    return dict(os.environ)


@pytest.fixture
def join(environment: dict[str, str], domain: int) -> Iterator[Callable[..., Judge]]:
    """Starts judges, by their names; each leaves when the test is over."""
    from judge import Judge

    with ExitStack() as held:

        def join(name: str = "judge") -> Judge:
            judge = Judge(domain, name)
            held.callback(judge.close)
            return judge

        yield join


@pytest.fixture
def judge(join: Callable[..., Judge]) -> Judge:
    """One judge."""
    return join()


@pytest.fixture(params=["dds", "rclpy"])
def middleware(request: pytest.FixtureRequest) -> str:
    """Each middleware of the bridge that speaks with ROS 2."""
    return str(request.param)


@pytest.fixture
def installed(middleware: str, environment: dict[str, str]) -> str:
    """Each middleware that is installed, in the domain of the test."""
    package, reason = {"dds": ("cyclonedds", NO_DDS), "rclpy": ("rclpy", NO_RCLPY)}[middleware]
    if not find_spec(package):
        pytest.skip(reason)
    return middleware


@pytest.fixture
def bridge(start: Start, middleware: str) -> Iterator[Callable[..., Bridge]]:
    """Starts bridges, with arguments for behind ``--ros-args``."""
    from judge import Bridge

    with ExitStack() as held:
        yield lambda *arguments: Bridge(start, middleware, arguments, held)
