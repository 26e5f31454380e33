"""Options, markers and fixtures of all tests."""

from __future__ import annotations

import contextlib
import functools
import gc
import importlib.metadata
import os
import socket
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from default_signals import restore_default_signals
from needs import EXHAUSTIVE, NO_ZENOH, SLOW
from programs import Program, Start

from roverlink.dds_domain import claim_domain, ports_of
from roverlink.runtime.middleware import open_zenoh_router

_REPOSITORY = Path(__file__).parent

os.environ.setdefault("HYPOTHESIS_NO_PLUGINS", "1")  # Selenium brings Trio, whose plugin takes a tenth of a second
with contextlib.suppress(ImportError):  # the environments of tests/ros2 have no Hypothesis
    from hypothesis import HealthCheck, settings
    from hypothesis.internal.conjecture import providers

    # A loaded machine says nothing about the code: no property has a deadline. Nor does a test fail by chance, and then
    # pass: the examples of a test are always the same, but in `make exhaustive`, which draws others in each run.
    for profile, fixed in (("exhaustive", False), ("default", True)):
        settings.register_profile(
            profile,
            max_examples=50,
            deadline=None,
            suppress_health_check=[HealthCheck.too_slow],
            derandomize=fixed,
            database=None,
        )
    settings.load_profile("default")


_entry_points = importlib.metadata.entry_points


@functools.cache
def _entry_points_on(_path: tuple[str, ...], **selected: str) -> Any:
    return _entry_points(**selected)


def _known_entry_points(**selected: str) -> Any:
    """Look for entry points once on each path: most commands do so, which reads a file of every installed package."""
    return _entry_points_on(tuple(sys.path), **selected)


importlib.metadata.entry_points = _known_entry_points  # type: ignore[assignment]  # before any of our modules imports it


def pytest_addoption(parser: pytest.Parser) -> None:
    """Know the option that writes golden files anew."""
    parser.addoption(
        "--update-cases",
        action="store_true",
        help="write the expectations of golden cases and of screens anew, to be reviewed as a diff",
    )


@pytest.hookimpl(optionalhook=True)  # -p no:xdist knows no such hook
def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """One worker more than there are cores: a fifth of the time, tests wait for sockets and programs."""
    return (os.cpu_count() or 1) + 1


def pytest_configure(config: pytest.Config) -> None:
    """Know the markers of the tests that take long, and give default signals to the programs that tests start."""
    config.addinivalue_line("markers", "slow: takes a third of a second or more; runs with -m")
    config.addinivalue_line(
        "markers", "opencv: judges what a version of OpenCV sees; make test-vision runs it, slow or not"
    )
    config.addinivalue_line("markers", "exhaustive: goes through thousands of cases, or takes minutes; runs with -m")
    if config.getoption("update_cases") and config.getoption("numprocesses", 0):
        raise pytest.UsageError("--update-cases writes files that all workers would share: run it without -n")
    if not config.getoption("markexpr") and "hypothesis" in sys.modules:
        # Hypothesis parses each of our modules for constants to draw: 6 s in each worker, if there is no cache yet.
        providers._get_local_constants = lambda: providers._local_constants
    restore_default_signals()
    gc.disable()  # collecting the tests makes many objects that stay, and no garbage


def pytest_collection_finish() -> None:
    """Collect garbage again, but do not look through the tests for it."""
    gc.freeze()
    gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave the tests that take long out, unless -m says what is to run."""
    if config.getoption("markexpr"):
        return
    for item in items:
        for marker, reason in (("exhaustive", EXHAUSTIVE), ("slow", SLOW)):
            if item.get_closest_marker(marker):
                item.add_marker(pytest.mark.skip(reason=reason))
                break


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say in one line how many tests were skipped, why, and which command runs them."""
    skipped = terminalreporter.stats.get("skipped", [])
    reasons = Counter(report.longrepr[2].removeprefix("Skipped: ") for report in skipped)
    if reasons:
        counts = ", ".join(f"{count} {reason}" for reason, count in reasons.most_common())
        terminalreporter.write_line(f"{len(skipped)} skipped: {counts}")


@pytest.fixture(scope="session", autouse=True)
def _cache_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep the user's cache folder out of the tests, those that start processes among them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture
def domain() -> Iterator[int]:
    """A DDS domain that nobody else on this host is in, ours until the test ends."""
    with contextlib.ExitStack() as held:
        yield claim_domain(held)


@pytest.fixture
def environment(domain: int) -> dict[str, str]:
    """An environment without ROS 2, on this host alone, in a domain that nobody else is in."""
    dropped = ("ROS_", "RMW_", "CYCLONEDDS", "PYTHONUNBUFFERED")  # output is buffered, as it is for users
    kept = {name: value for name, value in os.environ.items() if not name.startswith(dropped)}
    return {
        **kept,
        "PYTHONFAULTHANDLER": "1",
        "ROS_LOCALHOST_ONLY": "1",
        "ROS_DOMAIN_ID": str(domain),
        "COLUMNS": "200",
    }


@pytest.fixture
def free_port() -> Iterator[int]:
    """A TCP port of this host that nobody else gets until the test ends; a server may listen there (SO_REUSEADDR)."""
    with socket.socket() as held:
        held.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        held.bind(("127.0.0.1", 0))
        yield held.getsockname()[1]


@pytest.fixture
def free_udp_ports(domain: int) -> Sequence[int]:
    """UDP ports of this host that nobody else gets until the test ends: of our domain, beyond its participants."""
    return ports_of(domain)[200:-1]


@pytest.fixture
def zenoh_router(environment: dict[str, str], monkeypatch: pytest.MonkeyPatch, free_port: int) -> Iterator[str]:
    """The endpoint of a router of zenoh, to which the nodes of this process and those of its programs connect."""
    pytest.importorskip("zenoh", reason=NO_ZENOH)
    endpoint = f"tcp/127.0.0.1:{free_port}"
    override = f'mode="client";connect/endpoints=["{endpoint}"]'  # a peer waits half a second for others
    with open_zenoh_router([endpoint]):
        monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", override)
        environment["ZENOH_CONFIG_OVERRIDE"] = override
        yield endpoint


@pytest.fixture
def start(environment: dict[str, str]) -> Iterator[Start]:
    """Starts `roverlink` with arguments; ends what still runs when the test is over."""
    programs: list[Program] = []

    def start(*arguments: object, folder: Path = _REPOSITORY, **more: str) -> Program:
        program = Program(arguments, {**environment, **more}, folder)
        programs.append(program)
        return program

    yield start
    for program in programs:
        program.kill()


@pytest.fixture
def done(start: Start) -> Start:
    """Runs `roverlink` with arguments to its end; its exit code, standard output and standard error."""

    def done(*arguments: object, **more: object) -> tuple[int, str, str]:  # type: ignore[misc]
        program = start(*arguments, **more)
        code = program.end()
        return code, "\n".join(program.output), "\n".join(program.errors)

    return done  # type: ignore[return-value]
