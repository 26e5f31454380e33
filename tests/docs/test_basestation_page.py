"""docs/basestation.md: its programs talk with a real bridge."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import re
import shutil
import socket
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from needs import NO_ROS
from page import ROOT, Reader, blocks, ports_of
from polling import wait_until
from protobuf_cpp import in_one_file

from generated.pb2.components.basestation.detected_object_pb2 import OBJECT_ROCK, BasestationDetectedObject
from generated.pb2.components.sensor_board.gps_sensor_pb2 import SensorBoardGPSInfo
from generated.registry import REGISTRY
from roverlink.runtime.client import BlockingPeer
from roverlink.runtime.middleware import NodeIdentity
from roverlink.simulation.bridge_host import BridgeThread

_PAGE = ROOT / "docs" / "basestation.md"
_GPS = SensorBoardGPSInfo(latitude=50.0652, longitude=19.94532)
_MISSING = [tool for tool in ("g++", "protoc") if not shutil.which(tool)]
_MISSING += [] if Path("/usr/include/google/protobuf/message.h").exists() else ["libprotobuf"]


def _program(language: str) -> str:
    return next(block.text for block in blocks(_PAGE) if block.language == language)


def _follow(command: list[str], port: int, bridge: BridgeThread) -> None:
    """Run a basestation, and expect its command on the topic, and the rover's position and rock in its output."""
    commands: list[bytes] = []
    mode, rock = REGISTRY.by_name["control_mode"], REGISTRY.by_name["detected_object"]
    nodes = bridge.middleware(NodeIdentity("test"))
    nodes.subscribe("/control_mode", mode.message_type, mode.route.qos, commands.extend)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    output: list[str] = []
    with contextlib.ExitStack() as stack:
        child = stack.enter_context(subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True))
        stack.callback(child.kill)
        assert child.stdout is not None
        threading.Thread(target=lambda pipe=child.stdout: output.extend(pipe), daemon=True).start()
        wait_until(lambda: len(commands) > 1, "the repeated command")
        board = stack.enter_context(
            BlockingPeer.open("hardware", registry=REGISTRY, port=bridge.port, local_address="127.0.0.1", local_port=0)
        )
        # Directly to the basestation: it has to survive what is no envelope.
        stranger = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        stranger.sendto(b"\xff" * 5, ("127.0.0.1", port))
        board.send(_GPS)
        wait_until(lambda: output, "the position")
        publisher = nodes.publisher("/detected_object", rock.message_type, rock.route.qos)
        publisher.publish([rock.to_cdr(BasestationDetectedObject(frame_id=1, total_count=1, type=OBJECT_ROCK))])
        wait_until(lambda: len(output) > 1, "the rock")
    assert output[0].split()[:2] == ["rover", "at"]
    assert [round(float(word), 3) for word in output[0].split()[2:]] == [50.065, 19.945]
    assert output[1] in ("image 1: OBJECT_ROCK\n", "payload 17\n")


@pytest.mark.slow
def test_the_basestation_in_python_runs(tmp_path: Path, domain: int) -> None:
    """Its 30 lines receive, reassemble and command."""
    text = _program("python")
    assert len(text.splitlines()) <= 30
    with BridgeThread(REGISTRY, {"dst_a_port": (port := ports_of(domain)[0])}, "error") as bridge:
        script = tmp_path / "basestation.py"
        script.write_text(text.replace("host=host", f"host=host, port={bridge.port}, local_port={port}"))
        _follow([sys.executable, "-u", str(script), "127.0.0.1"], port, bridge)


@pytest.mark.slow
def test_the_basestation_runs_over_a_tcp_radio(tmp_path: Path, free_port: int) -> None:
    """The same program, with the line of the page in place of the host."""
    (host,) = re.findall(r'host: "(tcp:\S+)"', _PAGE.read_text(encoding="utf-8"))
    changes = {"basestation": {"host": host.replace("7000", str(free_port)), "host_parameter": "basestation_host"}}
    peers = tuple(dataclasses.replace(peer, **changes.get(peer.name, {})) for peer in REGISTRY.peers)
    with BridgeThread(dataclasses.replace(REGISTRY, peers=peers), {}, "error") as bridge:
        script = tmp_path / "basestation.py"
        script.write_text(_program("python"))
        _follow([sys.executable, "-u", str(script), f"tcp:127.0.0.1:{free_port}"], 9, bridge)


@pytest.mark.slow
@pytest.mark.skipif(bool(_MISSING), reason=NO_ROS)
def test_the_basestation_in_cpp_compiles_and_runs(tmp_path: Path, domain: int) -> None:
    """With the same .proto files, and every warning of the compiler as an error."""
    port = ports_of(domain)[0]
    (tmp_path / "basestation.cpp").write_text(_program("cpp").replace("6000", str(port)))
    proto, made = ROOT / "proto", tmp_path / "gen"
    made.mkdir()
    files = [path for path in (proto / "components").rglob("*.proto") if path.name != "message_types.proto"]
    subprocess.run(["protoc", "-I", proto, "--cpp_out", made, *files], check=True)
    compile = ["g++", "-std=c++17", "-Wall", "-Wextra", "-Werror", "-I", made, tmp_path / "basestation.cpp"]
    compile += [in_one_file(tmp_path / "protos.cpp", sorted(made.rglob("*.cc"))), "-lprotobuf", "-pthread"]
    compile += ["-o", tmp_path / "basestation"]
    subprocess.run(compile, check=True)
    with BridgeThread(REGISTRY, {"dst_a_port": port}, "error") as bridge:
        _follow([str(tmp_path / "basestation"), "127.0.0.1", str(bridge.port)], port, bridge)


@pytest.mark.slow
def test_a_slow_radio_is_spared(tmp_path: Path) -> None:
    """Followed in a copy of the project: five a second leave of fifty, and a state once."""
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(_PAGE, "A slow radio"))


_TYPES = """
from google.protobuf.message import Message
from roverlink.runtime.client import BlockingPeer, Frame, Received
from typing_extensions import assert_type


async def types(peer: Peer, blocking: BlockingPeer) -> None:
    assert_type(await peer.receive(), Received)
    assert_type(await peer.receive(SensorBoardGPSInfo), SensorBoardGPSInfo)
    assert_type(blocking.receive(timeout=1.0), Received)
    assert_type(blocking.receive(SensorBoardGPSInfo, timeout=1.0), SensorBoardGPSInfo)
    async for frame in peer.frames(BasestationDetectedObject):
        assert_type(frame, Frame[BasestationDetectedObject])
    async for number, payload in peer:
        assert_type(number, int)
        assert_type(payload, Message)
    async with Peer.open("basestation") as opened:
        assert_type(opened, Peer)
    peer.frames(SensorBoardGPSInfo)  # type: ignore[type-var]  # it is no part of a frame
"""


@pytest.mark.slow
def test_a_type_checker_knows_what_comes_out(tmp_path: Path) -> None:
    """The page's program is strictly typed, and the class that is asked for is the one that comes."""
    script = tmp_path / "basestation.py"
    script.write_text(_program("python") + _TYPES)
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path), str(script)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
