"""`roverlink link keygen`, and a bridge that is given the keys."""

from __future__ import annotations

import logging
import socket
import stat
import subprocess
from pathlib import Path
from typing import Any

import pytest
from polling import wait_until
from signed_project import NUMBER, make_signed_project

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime.keys.key_file import read_keys
from roverlink.runtime.keys.signed_links import SignedLinks

ROOT = Path(__file__).parents[2]


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


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("ros",), "'ros' is not the name of a peer or board"),
        (("base", "--rotate"), "base.keys: no such key file; `roverlink link keygen` makes one"),
        (("base", "--out", "nowhere/base.keys"), "nowhere/base.keys: cannot write the key file: No such file"),
    ],
)
def test_keygen_says_why_it_cannot(
    arguments: tuple[str, ...],
    expected: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Exit code 2 and one line."""
    monkeypatch.chdir(tmp_path)
    assert main(["link", "keygen", *arguments]) == 2
    assert expected in capsys.readouterr().err


def test_a_key_file_is_of_no_use_to_a_table_without_signing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The bridge does not start, because somebody believes that commands are signed."""
    assert main(["run", "--project", str(ROOT), "--middleware", "memory", "--key-file", str(tmp_path / "x.keys")]) == 2
    assert "the table has no `signing`" in capsys.readouterr().err


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """The sample rover, but its basestation must sign."""
    table = make_signed_project(tmp_path / "rover")
    assert main(["generate", "--table", str(table)]) == 0
    return table.parent


def test_a_bridge_without_the_key_does_not_start(project: Path, done: Any) -> None:
    """Exit code 2, the peer, and the two steps that help."""
    code, _, errors = done("run", "--project", project, "--middleware", "memory", folder=project)
    assert code == 2
    assert errors == (
        "roverlink: datagrams of 'basestation' must be signed (table key `sign`), but there is no key; make a key file "
        "with `roverlink link keygen basestation`, and give it to the bridge with --key-file FILE"
    )


def test_a_bridge_takes_commands_with_the_key_and_shows_it_nowhere(project: Path, start: Any, tmp_path: Path) -> None:
    """A signed command is published, an unsigned one and its replay after a restart are counted."""
    keys = tmp_path / "basestation.keys"
    assert main(["link", "keygen", "basestation", "--out", str(keys)]) == 0
    links = SignedLinks(NUMBER, [keys], logging.getLogger("basestation"), "basestation")
    signer = links.signer(["ros"])
    assert signer is not None
    command = REGISTRY.envelope(control_mode={"mode": 1}).SerializeToString()
    signed = signer.sign(command)
    recording = tmp_path / "run.mcap"
    options = ("--middleware", "memory", "--json", "--key-file", keys, "--log-format", "json")
    ros = ("--ros-args", "-p", "listen_port:=0", "-p", "listen_address:='127.0.0.1'", "--log-level", "debug")
    accounts, texts = [], []
    for datagrams in ((command, signed), (signed,)):
        program = start("run", "--project", project, *options, "--record", recording, *ros, folder=project)
        ready = program.wait_for('"port"', program.output)
        port = int(ready.partition('"port": ')[2].partition(",")[0])
        listing = subprocess.run(["ps", "-ww", "-o", "args=", str(program.pid)], capture_output=True, text=True).stdout
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            for datagram in datagrams:
                sock.sendto(datagram, ("127.0.0.1", port))
        wait_until(lambda program=program: "dropped" in str(program), "a dropped datagram")  # type: ignore[misc]
        assert program.interrupt() == 0
        accounts.append(program.output[-1])
        texts += [str(program), listing]
        recording = tmp_path / "again.mcap"
    assert '"dropped": {"unsigned": 1}' in accounts[0]
    assert '"published": 1' in accounts[0]
    assert '"dropped": {"outdated": 1}' in accounts[1]
    raw = [file.read_bytes() for file in tmp_path.glob("*.mcap")]
    assert len(raw) >= 4
    for secret in _secrets(keys):
        assert all(secret[:16] not in text for text in texts)
        assert all(bytes.fromhex(secret) not in content and secret.encode() not in content for content in raw)


def test_the_help_shows_no_key(capsys: pytest.CaptureFixture[str]) -> None:
    """A key is only ever given by a file."""
    with pytest.raises(SystemExit):
        main(["run", "--help"])
    assert "--key-file FILE" in capsys.readouterr().out
