"""Commands that tell what the link messages of boards say."""

from __future__ import annotations

import contextlib
import json
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from linked import linked_registry, write_project
from programs import Start
from repeating import repeated

from roverlink.runtime.core.link_message import LinkWriter


@contextlib.contextmanager
def _board(hashes: dict[int, int]) -> Iterator[list[str]]:
    """A board that answers each datagram with a link message, to its sender; yields the parameters of the bridge."""
    writer = LinkWriter(linked_registry().envelope, 7, hashes)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(0.1)

        def answer(_: int) -> None:
            with contextlib.suppress(TimeoutError):
                sock.sendto(writer.write(1), sock.recvfrom(2000)[1])

        with repeated(answer, 0):
            yield ["listen_port:=0", f"dst_b_port:={sock.getsockname()[1]}"]


@pytest.mark.slow
def test_doctor_names_the_board_with_another_schema(done: Start, tmp_path: Path) -> None:
    """It exchanges link messages: a row that differs is an error, and a peer that tells nothing is none."""
    registry = linked_registry()
    assert registry.link is not None
    project = write_project(tmp_path / "rover")
    with _board({2: registry.link.hashes[2], 3: 99}) as board:
        words = [word for one in board for word in ("-p", one)]
        code, output, errors = done("doctor", "--json", "--project", project, "--ros-args", *words)
    assert (code, errors) == (1, "")
    found = {one["check"]: (one["verdict"], one["says"]) for one in json.loads(output)}
    assert {check: one for check, one in found.items() if "schema" in check} == {
        "schema of Drive of hardware": ("error", "another schema of drive_command"),
        "schema of Arm of hardware": ("ok", "not known: no link message came within 2.5 s"),
        "schema of base": ("ok", "not known: no link message came within 2.5 s"),
    }
