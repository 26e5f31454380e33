"""docs/security.md: whoever follows the steps for signed datagrams gets a link that works."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any

import pytest
from page import ROOT
from polling import wait_until
from signed_project import NUMBER, make_signed_project

PAGE = (ROOT / "docs" / "security.md").read_text(encoding="utf-8")
SECTION = PAGE[PAGE.index("## Signed datagrams") : PAGE.index("## Bytes from outside")]

_BOARD = """\
#include "roverlink_signing.h"
#define PBEnvelope_signature_tag {number}
static uint64_t stored_clock, stored_last;
static uint8_t buffer[1500];
static size_t length;
static struct {{ size_t bytes_written; }} stream;
static uint64_t ticks_since_boot(void) {{ return 0; }}
int main(void) {{
{body}
return 0;
}}
"""


def _block(language: str, place: int = 0) -> str:
    found = re.findall(rf"^ *```{language}\n(.*?)^ *```$", SECTION, re.DOTALL | re.MULTILINE)
    return textwrap.dedent(found[place])


@pytest.mark.slow
def test_the_steps_lead_to_signed_commands(tmp_path: Path, start: Any, done: Any) -> None:
    """Table, generate, keygen, run, and the program of the basestation, as the page shows them."""
    table = make_signed_project(tmp_path / "rover")
    project = table.parent
    assert _block("yaml").splitlines()[0] in table.read_text(encoding="utf-8")
    assert done("generate", folder=project)[0] == 0
    envelope = (project / "proto/components/common/envelope.proto").read_text(encoding="utf-8")
    assert f"`bytes signature = {NUMBER};`" in SECTION
    assert f"bytes signature = {NUMBER};" in envelope
    command, _, shown = _block("console", 1).partition("\n")
    assert command == "$ roverlink link keygen basestation"
    assert done("link", "keygen", "basestation", folder=project)[1] == shown.rstrip()
    assert _block("console", 3) == "$ roverlink run --key-file basestation.keys\n"
    options = ("--middleware", "memory", "--key-file", "basestation.keys", "--json")
    ros = ("--ros-args", "-p", "listen_port:=0", "-p", "listen_address:='127.0.0.1'")
    bridge = start("run", *options, *ros, folder=project)
    port = bridge.wait_for("on UDP port ").rpartition(" ")[2]
    program = _block("python").replace("5000", port)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    for sent in (program, program.replace("signer.sign(command)", "command")):
        subprocess.run([sys.executable, "-c", sent], cwd=project, env=environment, check=True)
    wait_until(lambda: "has no signature" in str(bridge), "the unsigned command is dropped")
    assert bridge.interrupt() == 0
    assert '"published": 1' in bridge.output[-1]
    assert '"dropped": {"unsigned": 1}' in bridge.output[-1]


@pytest.mark.slow
def test_the_keys_are_changed_as_the_page_says(tmp_path: Path, done: Any) -> None:
    """After --rotate and the marks, the bridge's file has one key to send with for each direction."""
    assert "`roverlink link keygen basestation --rotate`" in SECTION
    assert done("link", "keygen", "basestation", folder=tmp_path)[0] == 0
    code, output, _ = done("link", "keygen", "basestation", "--rotate", folder=tmp_path)
    assert code == 0
    assert "new key 3 from basestation to ros" in output


def test_the_firmware_compiles(tmp_path: Path) -> None:
    """The page's excerpt of a board, with the functions that the target nanopb writes."""
    if shutil.which("gcc") is None:
        pytest.skip("need a C compiler (apt-get install gcc)")
    (tmp_path / "board.c").write_text(_BOARD.format(number=NUMBER, body=_block("c")), encoding="utf-8")
    library = ROOT / "cpp" / "c"
    command = ["gcc", "-std=c11", "-Wall", "-Werror", f"-I{library}", "board.c", str(library / "roverlink_signing.c")]
    subprocess.run([*command, "-o", "board"], cwd=tmp_path, check=True)
    subprocess.run([tmp_path / "board"], check=True)
