"""docs/connect-a-board.md: its commands compile its program, and the program talks with a real bridge."""

from __future__ import annotations

import dataclasses
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from lines import cable
from needs import needs_nanopb
from page import ROOT, blocks, ports_of
from polling import PATIENCE_S, wait_until

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime import Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import NodeIdentity
from roverlink.simulation.bridge_host import BridgeThread

_PAGE = blocks(ROOT / "docs" / "connect-a-board.md")
_RUN = "$ ./board 127.0.0.1 5000 6001\n"


@pytest.mark.slow
@needs_nanopb
def test_the_program_of_the_page_sends_and_receives(tmp_path: Path, domain: int) -> None:
    """Compiled as the page says, it prints what the page shows, and its sample arrives on the topic."""
    program, over_serial = (block.text for block in _PAGE if block.language == "c")
    (shown,) = (block.text.removeprefix(_RUN) for block in _PAGE if block.text.startswith(_RUN))
    (tmp_path / "board.c").write_text(program, encoding="utf-8")
    (tmp_path / "serial_board.c").write_text(over_serial, encoding="utf-8")
    for name in ("proto", "mapping.yaml", "mapping.lock"):
        (shutil.copytree if (ROOT / name).is_dir() else shutil.copy)(ROOT / name, tmp_path / name)
    _put_on_a_serial_port(tmp_path / "mapping.yaml")
    assert main(["generate", "--table", str(tmp_path / "mapping.yaml")]) == 0
    tools = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    for command in (block.text for block in _PAGE if block.language == "console"):
        script = command.replace("$ ", "", 1).replace("\n$ ", "\n")
        subprocess.run(["sh", "-ec", script], cwd=tmp_path, env={**os.environ, "PATH": tools}, check=True)
    port, imu, samples = ports_of(domain)[0], REGISTRY.by_name["imu_info"], list[bytes]()
    with BridgeThread(REGISTRY, {"dst_b_port": port}, "error") as bridge:
        nodes = bridge.middleware(NodeIdentity("test"))
        nodes.subscribe("/imu_data", imu.message_type, imu.route.qos, samples.extend)
        board = [str(tmp_path / "board"), "127.0.0.1", str(bridge.port), str(port)]
        done = subprocess.run(board, capture_output=True, text=True, timeout=PATIENCE_S, check=True)
        wait_until(lambda: samples, "the sample")
    assert done.stdout == shown
    _check(samples)
    with cable(tmp_path / "ttyACM0") as line, BridgeThread(_with_host(f"serial:{line.path}"), {}, "error") as bridge:
        samples.clear()
        nodes = bridge.middleware(NodeIdentity("test"))
        nodes.subscribe("/imu_data", imu.message_type, imu.route.qos, samples.extend)
        # As `<>/tmp/board >&0` of the page does; the first sample may come before the bridge has opened the device.
        board = [str(tmp_path / "serial_board")]
        ends = {"stdin": line.board, "stdout": line.board, "stderr": subprocess.PIPE}
        told = subprocess.run(board, **ends, text=True, timeout=PATIENCE_S, check=True).stderr
        wait_until(lambda: samples, "the sample over the serial line")
    assert told == shown
    _check(samples)


def _with_host(host: str) -> Registry:
    changes = {"hardware": {"host": host, "host_parameter": "hardware_host"}}
    peers = tuple(dataclasses.replace(peer, **changes.get(peer.name, {})) for peer in REGISTRY.peers)
    return dataclasses.replace(REGISTRY, peers=peers)


def _put_on_a_serial_port(table: Path) -> None:
    """Edit the table as the page shows."""
    (example,) = (block.text for block in _PAGE if block.language == "yaml")
    targets, host = example.splitlines()[0], example.splitlines()[-1]
    text = table.read_text(encoding="utf-8")
    text = text.replace("version: 1\n", f"version: 1\n\n{targets}\n").replace("  hardware:\n", f"  hardware:\n{host}\n")
    table.write_text(text, encoding="utf-8")


def _check(samples: list[bytes]) -> None:
    imu = REGISTRY.by_name["imu_info"]
    sample: Any = cdr.decode(imu.message_type, samples[0])
    assert (round(sample.accel_z, 2), sample.is_calibrated) == (9.81, True)
