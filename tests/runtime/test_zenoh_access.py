"""The configuration in docs/fleet.md, as it stands there: a real router with TLS, access control and down-sampling."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from needs import NO_ZENOH
from polling import wait_until

from generated.messages import ImuSensorInformation
from roverlink.runtime import MiddlewareError, Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import RowService
from roverlink.runtime.interfaces import rcl_interfaces as rcl
from roverlink.runtime.middleware import Middleware, NodeIdentity, open_middleware, open_zenoh_router

pytest.importorskip("zenoh", reason=NO_ZENOH)
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("openssl") is None, reason="needs openssl, which makes the certificates"),
]

_PAGE = Path(__file__).parents[2] / "docs" / "fleet.md"
_MESSAGE = cdr.encode(ImuSensorInformation())
_QOS, _LATCHED = Qos(), Qos(durability="transient_local", depth=1)
_TYPES = RowService("get_parameter_types", rcl.GetParameterTypesRequest, rcl.GetParameterTypesResponse)
Join = Callable[[str], Middleware]


@pytest.fixture(scope="module")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the certificates of a fleet, the names of which are their owners'."""
    folder = tmp_path_factory.mktemp("certificates")
    (folder / "openssl.cnf").write_text("[req]\ndistinguished_name = name\n[name]\n")
    _make_certificate(folder, "ca", "basicConstraints=critical,CA:TRUE")
    for name in ("router", "rover1", "basestation", "spectator", "thief"):
        _make_certificate(folder, name, "subjectAltName=DNS:router.local,DNS:localhost", "-CA ca.pem -CAkey ca.key")
    return folder


@pytest.fixture
def join(certificates: Path, monkeypatch: pytest.MonkeyPatch, free_port: int) -> Iterator[Join]:
    """Joins the router of the page as the owner of a certificate, with the page's file for a rover."""
    monkeypatch.chdir(certificates)
    monkeypatch.delenv("ZENOH_CONFIG_OVERRIDE", raising=False)
    router, rover = re.findall(r"```json5\n(.*?)```", _PAGE.read_text(encoding="utf-8"), re.DOTALL)
    Path("router.json5").write_text(router.replace("[::]:7447", f"localhost:{free_port}"))
    monkeypatch.setenv("ZENOH_ROUTER_CONFIG_URI", "router.json5")
    with ExitStack() as joined:

        def as_owner(name: str) -> Middleware:
            text = rover.replace("router.local:7447", f"localhost:{free_port}").replace("rover1", name)
            Path(f"{name}.json5").write_text(text)
            monkeypatch.setenv("ZENOH_SESSION_CONFIG_URI", f"{name}.json5")
            return joined.enter_context(open_middleware("zenoh", NodeIdentity(name)))

        joined.enter_context(open_zenoh_router([]))
        yield as_owner


def _make_certificate(folder: Path, name: str, extension: str, signed_by: str = "") -> None:
    command = (
        "openssl req -x509 -config openssl.cnf -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 "
        f"-subj /CN={name} -addext {extension} -keyout {name}.key -out {name}.pem {signed_by}"
    )
    subprocess.run(shlex.split(command), cwd=folder, check=True, capture_output=True)


def _heard(node: Middleware, topic: str, qos: Qos = _QOS) -> list[bytes]:
    heard: list[bytes] = []
    node.subscribe(topic, ImuSensorInformation, qos, heard.extend)
    return heard


def test_each_end_may_do_what_the_page_says(join: Join) -> None:
    """A basestation commands, a rover speaks for itself, a spectator only listens, and a stranger sees nothing."""
    rover, base, spectator, thief = map(join, ("rover1", "basestation", "spectator", "thief"))
    latched = rover.publisher("/rover1/map", ImuSensorInformation, _LATCHED)
    latched.publish([_MESSAGE])
    rover.offer("/rover1/types", _TYPES, lambda _, respond: respond(b"types"))
    commands = _heard(rover, "/rover1/drive")
    of_another = _heard(base, "/rover2/imu_data")
    foreign = rover.publisher("/rover2/imu_data", ImuSensorInformation, _QOS)
    readers = {name: _heard(node, "/rover1/map", _LATCHED) for name, node in (("base", base), ("spectator", spectator))}
    stolen = _heard(thief, "/rover1/map", _LATCHED)
    wait_until(lambda: all(readers.values()), "the latched message")
    answers: list[bytes] = []
    ends = [
        (node.publisher("/rover1/drive", ImuSensorInformation, _QOS), node.client("/rover1/types", _TYPES))
        for node in (thief, spectator, base)
    ]
    publishers = [foreign, *(end[0] for end in ends[1:])]
    wait_until(lambda: all(publisher.has_subscribers() for publisher in publishers), "the subscriptions")
    foreign.publish([_MESSAGE])
    for kind, (publisher, client) in enumerate(ends):
        publisher.publish([_MESSAGE[:-1] + bytes([kind])])
        client.call(b"", lambda answer, kind=kind: answers.append(answer + bytes([kind])))  # type: ignore[misc]
    wait_until(lambda: commands and answers, "what the basestation may do")
    assert (commands, answers) == ([_MESSAGE[:-1] + b"\2"], [b"types\2"])
    assert (of_another, stolen, thief.endpoints("/rover1/map", True)) == ([], [], [])
    assert not ends[0][0].has_subscribers()


def test_images_are_thinned_out(join: Join) -> None:
    """Of images, two a second pass the router; of other topics, all messages."""
    rover, base = map(join, ("rover1", "basestation"))
    topics = ("/rover1/image_raw", "/rover1/imu_data")
    images, others = (_heard(base, topic) for topic in topics)
    publishers = [rover.publisher(topic, ImuSensorInformation, _QOS) for topic in topics]
    wait_until(lambda: all(publisher.has_subscribers() for publisher in publishers), "the subscriptions")
    began = time.monotonic()
    for _ in range(30):
        for publisher in publishers:
            publisher.publish([_MESSAGE])
        time.sleep(0.05)  # the rate is what is judged
    wait_until(lambda: len(others) == 30, "the messages")
    assert 1 < len(images) < 3 + 2 * (time.monotonic() - began)


def test_without_a_certificate_of_the_fleet_nobody_gets_in(join: Join, monkeypatch: pytest.MonkeyPatch) -> None:
    """A certificate that somebody else has signed opens no session, and the refusal is one line."""
    _make_certificate(Path(), "rover2", "subjectAltName=DNS:localhost")
    monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", "connect/timeout_ms=500")
    with pytest.raises(MiddlewareError, match=r"^zenoh cannot open a session: Unable to connect[^\n]*$"):
        join("rover2")
