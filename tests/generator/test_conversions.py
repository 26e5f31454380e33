"""What generated code does with values agrees with the table, and its bytes with an independent implementation."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from case_file import CaseFile
from golden import passing_cases

_CROSSCHECK = Path(__file__).parent / "crosscheck.py"
_ABOUT_OTHER_THINGS = {
    *("addresses", "boards", "boards_by_name", "comments", "deprecated", "envelope_of_another_owner"),
    *("extensions", "guards", "json_schemas", "ledger_merge_conflict", "ledger_one_number_in_two_branches"),
    *("ledger_row_changed_on_purpose", "ledger_without_rows", "nanopb_options", "only_what_is_needed"),
    *("own_templates", "qos_and_peers", "retired", "retired_signature", "signing", "tab107_topic_changed"),
}
_CASES = [case for case in passing_cases() if case.name not in _ABOUT_OTHER_THINGS]
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


@pytest.mark.slow
@pytest.mark.parametrize("case", _CASES, ids=lambda case: case.name)
def test_generated_code_agrees_with_the_table_and_with_rosbags(
    case: CaseFile, crosscheck: Callable[[Path], str], tmp_path: Path
) -> None:
    """Any payload becomes the ROS message that the table means, in the bytes that rosbags reads, and comes back."""
    wrong = crosscheck(case.write_inputs(tmp_path))
    assert not wrong, wrong
