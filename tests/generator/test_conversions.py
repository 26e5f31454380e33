"""What generated code does with values agrees with the table, and its bytes with an independent implementation."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from golden import ROOT, passing_cases

_CROSSCHECK = Path(__file__).parent / "crosscheck.py"
_ABOUT_OTHER_THINGS = {
    *("addresses", "boards", "boards_by_name", "comments", "deprecated", "envelope_of_another_owner"),
    *("extensions", "guards", "json_schemas", "ledger_merge_conflict", "ledger_one_number_in_two_branches"),
    *("ledger_row_changed_on_purpose", "ledger_without_rows", "nanopb_options", "only_what_is_needed"),
    *("own_templates", "qos_and_peers", "retired", "retired_signature", "signing", "tab107_topic_changed"),
}
_EXAMPLES = 25


@pytest.fixture(scope="module")
def crosscheck() -> Iterator[Callable[[Path], str]]:
    """Checks the generated code of a project; what is wrong with it."""
    with subprocess.Popen(
        [sys.executable, _CROSSCHECK], text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as server:
        assert server.stdin is not None
        assert server.stdout is not None

        def check(project: Path) -> str:
            print(_EXAMPLES, project, file=server.stdin, flush=True)
            return "" if server.stdout.readline() == "0\n" else (project / "crosscheck.log").read_text(encoding="utf-8")

        yield check
        server.stdin.close()


def _write_sample(folder: Path) -> Path:
    """Write the inputs of this repository's own table; return the folder."""
    shutil.copy(ROOT / "mapping.yaml", folder)
    shutil.copytree(ROOT / "proto", folder / "proto")
    return folder


_CASES = {case.name: case.write_inputs for case in passing_cases() if case.name not in _ABOUT_OTHER_THINGS}


@pytest.mark.slow
@pytest.mark.parametrize("write", [*_CASES.values(), _write_sample], ids=[*_CASES, "sample"])
def test_generated_code_agrees_with_the_table_and_with_rosbags(
    write: Callable[[Path], Path], crosscheck: Callable[[Path], str], tmp_path: Path
) -> None:
    """Any payload becomes the ROS message that the table means, in the bytes that rosbags reads, and comes back."""
    wrong = crosscheck(write(tmp_path))
    assert not wrong, wrong
