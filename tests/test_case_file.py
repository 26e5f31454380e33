"""Case files keep every byte of the files in them, and only their expectations are rewritten."""

from __future__ import annotations

import re
from pathlib import Path

from case_file import USUAL_TABLE, case_files, parse, render
from hypothesis import example, given
from hypothesis import strategies as st

_TESTS = Path(__file__).parent
_CASES = case_files(_TESTS / "generator" / "cases")
_CONTENT = st.binary() | st.text(st.sampled_from("a \\-x0\n\r\t\x85\ufeff é")).map(str.encode)


@given(st.dictionaries(st.sampled_from(["a.proto", "expected/b c.py", "stderr"]), _CONTENT))
@example({"no_line_end": b"x", "only_line_ends": b"\n\n", "spaces": b" x \t\n"})
@example({"a_case": b"-- stderr --\nx\n-- exit (escaped) --\n", "nearly": b"--  --\n-- x\n"})
@example({"escapes": b"\\x41 \\\\ \\\n", "escapes_without_line_end": b"\\x41 \\\\ \\"})
def test_every_byte_survives(files: dict[str, bytes]) -> None:
    """Line ends, spaces at the end of a line, missing line ends, markers and binary files are read as they were."""
    assert parse(render("A sentence.\n\n", files)) == ("A sentence.\n\n", files)


def test_a_file_has_many_cases(tmp_path: Path) -> None:
    """The cases of a file share what stands before them, add files, change the table, and are updated alone."""
    file = tmp_path / "many.cases"
    shared = "use: shared/imu.proto as proto/a.proto\n\n-- table --\nmessages:\n  - {number: 1}\n"
    first = "== first: One.\n-- table --\n  - {number: 2}\npeers: {}\n-- found --\n"
    second = "== second: Two.\nuse: shared/drive.proto as proto/b.proto\n-- proto/a.proto (proto3) --\nmessage A {}\n"
    file.write_text(shared + first + second)
    one, two = case_files(tmp_path)
    usual = USUAL_TABLE[: USUAL_TABLE.index("peers:")]
    assert (
        one.inputs["mapping.yaml"].decode() == f"{usual}messages:\n  - {{number: 1}}\n  - {{number: 2}}\npeers: {{}}\n"
    )
    assert [*two.inputs] == ["proto/a.proto", "mapping.yaml", "proto/b.proto"]
    assert two.inputs["proto/a.proto"] == b'syntax = "proto3";\nmessage A {}\n'
    one.update({"found": "new\n"})
    assert file.read_text() == f"{shared}{first}new\n{second}"


def test_cases_are_tidy() -> None:
    """Each case opens with the sentence that it proves, and is spelled as --update-cases spells it."""
    texts = {case.name: case.text for case in _CASES}
    assert len(texts) == len(_CASES)
    assert [name for name, text in texts.items() if not re.match(r"[^\n].*?\.\n(\n|--|use:)", text, re.DOTALL)] == []
    assert [name for name, text in texts.items() if render(*parse(text)) != text] == []


def test_every_shared_file_is_used() -> None:
    """No file is left in tests/shared/ that no case uses."""
    texts = "".join(path.read_text(encoding="utf-8") for path in {case.path for case in _CASES})
    lint = "".join(path.read_text(encoding="utf-8") for path in _TESTS.glob("lint/cases/*.yaml"))
    texts += "".join(f"use: shared/ledgers/{name}.lock as " for name in re.findall(r"ledger: (\w+)", lint))
    shared = [path.relative_to(_TESTS).as_posix() for path in (_TESTS / "shared").rglob("*") if path.is_file()]
    assert [path for path in shared if f"use: {path} as " not in texts] == []
