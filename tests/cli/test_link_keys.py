"""`roverlink link keygen`, and a bridge that is given the keys."""

from __future__ import annotations

import json
import logging
import resource
import socket
import stat
import subprocess
from pathlib import Path

import pytest
from polling import wait_until
from programs import Start
from running import Bridge
from signed_project import NUMBER, make_signed_project

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime.keys.key_file import read_keys
from roverlink.runtime.keys.signed_links import SignedLinks


def _secrets(path: Path) -> list[str]:
    return [one.key.secret.hex() for one in read_keys(path)]


def test_keygen_makes_a_file_and_shows_no_secret(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The file is for its owner, and neither output nor errors have a part of a secret."""
    monkeypatch.chdir(tmp_path)
    assert main(["link", "keygen", "basestation"]) == 0
    file = tmp_path / "basestation.keys"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert main(["link", "keygen", "basestation"]) == 2
    assert main(["link", "keygen", "basestation", "--rotate"]) == 0
    shown = "".join(capsys.readouterr())
    assert "basestation.keys: new key 1 from basestation to ros" in shown
    assert "roverlink: basestation.keys: the file exists" in shown
    assert len(read_keys(file)) == 4
    assert all(secret[:8] not in shown for secret in _secrets(file))


def test_a_full_disk_leaves_no_empty_key_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The next attempt works: no file without keys is in its way."""
    path = tmp_path / "basestation.keys"
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
    try:
        assert main(["link", "keygen", "basestation", "--out", str(path)]) == 2
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert "cannot write the key file: File too large" in capsys.readouterr().err
    assert not path.exists()


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """The sample rover, but its basestation must sign."""
    table = make_signed_project(tmp_path / "rover")
    assert main(["generate", "--table", str(table)]) == 0
    return table.parent


@pytest.mark.slow
def test_a_bridge_takes_commands_with_the_key_and_shows_it_nowhere(
    project: Path, done: Start, bridge: Bridge, tmp_path: Path, peer: socket.socket
) -> None:
    """Without the key it does not start; a signed command is published, an unsigned one is counted."""
    words = ("run", "--project", project, "--middleware", "memory")
    told = (
        "datagrams of 'basestation' must be signed (table key `sign`), but there is no key; make a key file with "
        "`roverlink link keygen basestation`, and give it to the bridge with --key-file FILE"
    )
    assert done(*words, folder=project) == (2, "", f"roverlink: {told}")
    keys = tmp_path / "basestation.keys"
    assert main(["link", "keygen", "basestation", "--out", str(keys)]) == 0
    signer = SignedLinks(NUMBER, [keys], logging.getLogger("basestation"), "basestation").signer(["ros"])
    assert signer is not None
    command = REGISTRY.envelope(control_mode={"mode": 1}).SerializeToString()
    signed = signer.sign(command)
    options = ("--project", project, "--json", "--key-file", keys, "--log-format", "json")
    recording = tmp_path / "run.mcap"
    program, port = bridge(*options, "--record", recording, ros=["--log-level", "debug"], folder=project)
    listing = subprocess.run(["ps", "-ww", "-o", "args=", str(program.pid)], capture_output=True, text=True).stdout
    for datagram in (command, signed):
        peer.sendto(datagram, ("127.0.0.1", port))
    wait_until(lambda: "dropped" in str(program), "a dropped datagram")
    assert program.interrupt() == 0
    account, texts = json.loads(program.output[-1]), [str(program), listing]
    assert (account["dropped"], account["published"]) == ({"unsigned": 1}, 1)
    raw = [file.read_bytes() for file in tmp_path.glob("*.mcap")]
    assert len(raw) >= 2
    for secret in _secrets(keys):
        assert all(secret[:16] not in text for text in texts)
        assert all(bytes.fromhex(secret) not in content and secret.encode() not in content for content in raw)
