"""docs/connect-a-board.md: its commands compile its program, and the program talks with a real bridge."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from needs import needs_nanopb
from page import ROOT, blocks, ports_of
from polling import PATIENCE_S, wait_until

from generated.registry import REGISTRY
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import NodeIdentity
from roverlink.simulation.bridge_host import BridgeThread

_PAGE = blocks(ROOT / "docs" / "connect-a-board.md")
_RUN = "$ ./board 127.0.0.1 5000 6001\n"


@pytest.mark.slow
@needs_nanopb
def test_the_program_of_the_page_sends_and_receives(tmp_path: Path, domain: int) -> None:
    """Compiled as the page says, it prints what the page shows, and its sample arrives on the topic."""
    (program,) = (block.text for block in _PAGE if block.language == "c")
    (shown,) = (block.text.removeprefix(_RUN) for block in _PAGE if block.text.startswith(_RUN))
    (tmp_path / "board.c").write_text(program, encoding="utf-8")
    shutil.copytree(ROOT / "proto", tmp_path / "proto")
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
    sample: Any = cdr.decode(imu.message_type, samples[0])
    assert (round(sample.accel_z, 2), sample.is_calibrated) == (9.81, True)
