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
    *("comments", "deprecated", "envelope_of_another_owner", "extensions", "ledger_merge_conflict"),
    *("ledger_one_number_in_two_branches", "only_what_is_needed", "qos_and_peers", "retired"),
    *("json_schemas", "nanopb_options", "own_templates", "guards", "expect_rate", "tab107_topic_changed"),
    *("addresses", "boards", "boards_by_name", "ledger_row_changed_on_purpose", "ledger_without_rows"),
    *("retired_signature", "signing", "tab111_to_tab113_warnings"),
}
_LESS_LIKELY_TO_BREAK = {
    *("empty_messages", "long_constructs", "long_names", "names_of_python", "one_message_in_two_rows", "packages"),
    *("dialects", "nested", "optional", "proto2_and_editions", "renamed_and_ignored", "standard_absences"),
    *("cpp_handlers", "standard_lists", "standard_of_one_distribution", "standard_times", "standard_units"),
    *("any_of", "maps", "awkward_constructs", "standard_axes", "standard_enums", "standard_enum_names"),
    *("hyphenated_paths", "names_by_rule", "only_standard_messages", "python_package", "standard_euler"),
}
_CASES = [
    pytest.param(case, marks=[pytest.mark.slow] if case.name in _LESS_LIKELY_TO_BREAK else [])
    for case in passing_cases()
    if case.name not in _ABOUT_OTHER_THINGS
]


@pytest.fixture(scope="module")
def crosscheck() -> Iterator[Callable[[Path], str]]:
    """Checks the generated code of a project; what is wrong with it."""
    with subprocess.Popen(
        [sys.executable, _CROSSCHECK], text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as server:
        assert server.stdin is not None
        assert server.stdout is not None

        def check(project: Path) -> str:
            print(project, file=server.stdin, flush=True)
            return "" if server.stdout.readline() == "0\n" else (project / "crosscheck.log").read_text(encoding="utf-8")

        yield check
        server.stdin.close()


@pytest.mark.parametrize("case", _CASES, ids=lambda case: case.name)
def test_generated_code_agrees_with_the_table_and_with_rosbags(
    case: CaseFile, crosscheck: Callable[[Path], str], tmp_path: Path
) -> None:
    """Any payload becomes the ROS message that the table means, in the bytes that rosbags reads, and comes back."""
    wrong = crosscheck(case.write_inputs(tmp_path))
    assert not wrong, wrong
