"""`roverlink lint --against X --with-buf`: what an installed buf finds, beside our own findings, in all our formats."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable
from operator import itemgetter
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import buf
import pytest
from buf import needs_buf
from case_file import usual_table
from comparing import ROOT, changes_found, compiled
from mutations import MUTATIONS, together, write
from repositories import RepositoryBuilder

from roverlink.generator.lint.buf import breaking, unstated
from roverlink.generator.protos.protoc import compile_tree
from roverlink.generator.protos.schema import Schema

_BEFORE = """\
syntax = "proto3";

package rover;

message Imu {
  int32 heading = 1;
  int32 turns = 2;
  float speed = 3;
  float spare = 4;
}

enum Mode {
  MODE_IDLE = 0;
  MODE_DRIVE = 1;
}
"""
_AFTER = """\
syntax = "proto3";

package rover;

message Imu {
  int32 heading = 1 [json_name = "yaw"];
  int64 turns = 2;
  string speed = 3;
}

enum Mode {
  MODE_IDLE = 0;
  MODE_DRIVE_ROVER = 1;
}
"""
_TABLE = usual_table("""\
envelope: {file: envelope.proto, message: Envelope, oneof: payload, owner: proto}
messages:
  - {number: 1, name: imu, proto: rover.Imu, topic: imu, direction: board_to_ros}
""")
_ENVELOPE = 'syntax = "proto3";\nimport "imu.proto";\nmessage Envelope { oneof payload { rover.Imu imu = 1; } }\n'


Run = Callable[..., tuple[int, str, str]]
Found = Callable[..., tuple[int, dict[str, dict[str, Any]]]]


@pytest.fixture
def lint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run: Run) -> Run:
    """Lint the tree `after` against `before`, with further arguments."""
    for name, text in (("before", _BEFORE), ("after", _AFTER)):
        write({"imu.proto": text}, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    return lambda *more, against="before": run("lint", "after", "--against", against, "--with-buf", *more)


@pytest.fixture
def by_rule(lint: Run) -> Found:
    """The exit code, and the last finding of each rule."""

    def call(against: str = "before") -> tuple[int, dict[str, dict[str, Any]]]:
        code, out, _ = lint("--format", "json", against=against)
        return code, {one["id"]: one for one in json.loads(out)}

    return call


@pytest.fixture
def project(tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[dict[str, Any]]]:
    """Lint a project with a table against its earlier state, with these lines behind the table."""
    for name, text in (("was", _BEFORE), (".", _AFTER)):
        write({"mapping.yaml": _TABLE, "proto/envelope.proto": _ENVELOPE, "proto/imu.proto": text}, tmp_path / name)
    monkeypatch.chdir(tmp_path)

    def call(row: str = "", behind: str = "") -> list[dict[str, Any]]:
        table = _TABLE.replace("board_to_ros}", f"board_to_ros{row}}}") + behind
        (tmp_path / "mapping.yaml").write_text(table)
        found: list[dict[str, Any]] = json.loads(run("lint", "--against", "was", "--with-buf", "--format", "json")[1])
        return found

    return call


@pytest.fixture
def other_bin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the Python interpreter, which has no buf; neither has the PATH."""
    folder = tmp_path / "bin"
    python = _executable(folder / "python", f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    monkeypatch.setattr(sys, "executable", str(python))
    monkeypatch.setenv("PATH", str(tmp_path / "nowhere"))
    return folder


def _executable(path: Path, text: str) -> Path:
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    path.chmod(0o755)
    return path


_ALL = {"WIR101", "WIR102", "FIELD_SAME_JSON_NAME", "FIELD_SAME_TYPE", "ENUM_VALUE_SAME_NAME"}


# --- what is shown ---


@pytest.mark.slow
@needs_buf
def test_text_has_both_and_no_fault_twice(lint: Run) -> None:
    """Buf's findings have buf's names; of a field that ours is about, there is ours alone."""
    assert lint() == (
        1,
        """\
after/imu.proto:5:1: error[WIR102] `spare = 4` was deleted from 'rover.Imu', but its number is not reserved
5 | message Imu {
  | ^
  before/imu.proto:9:3: it was `float spare = 4;` here
  help: put back `float spare = 4;`, or write `reserved 4; reserved "spare";`

after/imu.proto:6:22: warning[FIELD_SAME_JSON_NAME] Field "1" with name "heading" on message "Imu" changed option \
"json_name" from "heading" to "yaw".
6 |   int32 heading = 1 [json_name = "yaw"];
  |                      ^
  help: see https://buf.build/docs/breaking/rules/#field_same_json_name

after/imu.proto:7:3: warning[FIELD_SAME_TYPE] Field "2" with name "turns" on message "Imu" changed type from "int32" \
to "int64".
7 |   int64 turns = 2;
  |   ^
  help: see https://buf.build/docs/breaking/rules/#field_same_type

after/imu.proto:8:3: error[WIR101] `speed = 3` was float and is now string: a receiver of the other version skips the \
value as unknown
8 |   string speed = 3;
  |   ^
  before/imu.proto:8:3: it was `float speed = 3;` here
  help: put back `float speed = 3;`; or give it the free number 5: `string speed = 5; reserved 3;`

after/imu.proto:13:22: warning[ENUM_VALUE_SAME_NAME] Enum value "1" on enum "Mode" changed name from "MODE_DRIVE" to \
"MODE_DRIVE_ROVER".
13 |   MODE_DRIVE_ROVER = 1;
   |                      ^
  help: see https://buf.build/docs/breaking/rules/#enum_value_same_name

2 errors, 3 warnings
""",
        "",
    )


@pytest.mark.slow
@needs_buf
def test_formats_have_what_scripts_ask_for(lint: Run, by_rule: Found) -> None:
    """A finding of buf's has type and number as ours have; its rule is declared, and is a failed test."""
    code, found = by_rule()
    assert (code, set(found)) == (1, _ALL)
    parts = itemgetter("name", "severity", "message_type", "number", "path", "line", "column")
    assert parts(found["FIELD_SAME_TYPE"]) == ("buf-breaking", "warning", "rover.Imu", 2, "imu.proto", 7, 3)
    [run] = json.loads(lint("--format", "sarif")[1])["runs"]
    results = {result["ruleId"]: result for result in run["results"]}
    assert results.keys() == _ALL
    assert {rule["id"] for rule in run["tool"]["driver"]["rules"]} >= _ALL
    assert results["FIELD_SAME_TYPE"]["level"] == "warning"
    _, out, _ = lint("--format", "github")
    assert "::warning file=after/imu.proto,line=7,col=3,title=FIELD_SAME_TYPE buf-breaking::Field " in out
    suite = ElementTree.fromstring(lint("--format", "junit")[1])  # noqa: S314  # our own output
    assert "FIELD_SAME_TYPE buf-breaking" in [case.get("name") for case in suite if case.find("failure") is not None]


@pytest.mark.slow
@needs_buf
def test_exit_codes(lint: Run, tmp_path: Path) -> None:
    """0 if buf and we find nothing; buf's findings are warnings, which --fail-on error lets pass."""
    write({"imu.proto": _BEFORE.replace("int32 turns", "int64 turns")}, tmp_path / "after")
    assert lint()[0] == 1
    assert lint("--fail-on", "error")[0] == 0
    write({"imu.proto": _BEFORE}, tmp_path / "after")
    assert lint() == (0, "No problems found.\n", "")
    # What has no place any more is at the folder.
    write({"gone.proto": 'syntax = "proto3";\npackage rover;\nmessage Gone {}\n'}, tmp_path / "before")
    assert 'after: warning[FILE_NO_DELETE] Previously present file "gone.proto" was deleted.\n' in lint()[1]


# --- other states, and what is around ---


@pytest.mark.slow
@needs_buf
def test_a_git_ref_and_a_descriptor_set(by_rule: Found, tmp_path: Path) -> None:
    """Buf compares with whatever the lint compares with; a missing state is what it is without buf."""
    expected = by_rule()[1].keys()
    RepositoryBuilder(tmp_path / "after").commits({"imu.proto": _BEFORE}).write()
    write({"imu.proto": _AFTER}, tmp_path / "after")
    assert by_rule("HEAD")[1].keys() == expected
    schema, _ = compile_tree(tmp_path / "before", ["imu.proto"], "before")
    (tmp_path / "set.binpb").write_bytes(schema.descriptors.SerializeToString())
    assert by_rule("set.binpb")[1].keys() == expected
    code, found = by_rule("v0.1")
    assert (code, [*found]) == (2, ["STA101"])


@pytest.mark.slow
@needs_buf
def test_no_network_and_no_configuration(lint: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither a buf.yaml, be it broken or with dependencies elsewhere, nor a home folder is asked."""
    expected = lint()
    broken = "version: v2\ndeps: [buf.build/googleapis/googleapis]\nbreaking: {use: [NO_SUCH]}\nwrong: [\n"
    for folder in (".", "before", "after"):
        write({"buf.yaml": broken, "buf.work.yaml": broken}, tmp_path / folder)
    for name in ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)
    for name in ("http_proxy", "https_proxy", "HTTP_PROXY", "HTTPS_PROXY"):
        monkeypatch.setenv(name, "http://127.0.0.1:9")
    assert lint() == expected


@pytest.mark.slow
@needs_buf
@pytest.mark.parametrize(("side", "refused"), [("before", "STA102"), ("after", "PRO101")])
def test_what_does_not_compile_is_not_deleted(by_rule: Found, tmp_path: Path, side: str, refused: str) -> None:
    """A file that protoc refuses is one finding; buf compares the others, but no empty state."""
    other = 'syntax = "proto3";\npackage rover;\nmessage Other {}\n'
    for name in ("before", "after"):
        write({"other.proto": f"{other}message {{\n" if name == side else other}, tmp_path / name)
    code, found = by_rule()
    assert (code, set(found)) == (1, {*_ALL, refused})
    for name in ("imu.proto", "other.proto"):
        write({name: "message {\n"}, tmp_path / "after")
    code, found = by_rule()
    assert {"PRO101"} <= set(found) <= {"PRO101", "STA102"}


@pytest.mark.slow
@needs_buf
@pytest.mark.parametrize(
    ("row", "behind", "left"),
    [
        ("", "", "warning"),
        ("", "lint:\n  FIELD_SAME_TYPE: {severity: hint, reason: agreed}\n", "hint"),
        ("", 'lint:\n  FIELD_SAME_TYPE: {severity: "off", reason: agreed}\n', None),
        (", lint: {FIELD_SAME_TYPE: {severity: hint, reason: agreed}}", "", "hint"),
        ("", "lint:\n  FIELD_SAME_TYPE: {severity: warning, reason: agreed}\n", "warning"),
    ],
)
def test_the_table_lowers_them(
    project: Callable[..., list[dict[str, Any]]], row: str, behind: str, left: str | None
) -> None:
    """Settings under `lint` take buf's names, of the whole table or of a row; buf's findings are warnings anyway."""
    found = {one["id"]: one for one in project(row, behind)}
    assert found.get("FIELD_SAME_TYPE", {}).get("severity") == left
    assert found["FIELD_SAME_JSON_NAME"]["severity"] == "warning"
    said = found.get("TAB108", {}).get("message")
    lowers_nothing = "FIELD_SAME_TYPE (buf-breaking) has severity warning; 'warning' is not lower"
    assert said == (lowers_nothing if "severity: warning" in behind else None)


@needs_buf
def test_a_payload_of_the_envelope_is_said_once(project: Callable[..., list[dict[str, Any]]], tmp_path: Path) -> None:
    """Of a payload's number, the rules for the envelope say more than buf does."""
    write({"proto/imu.proto": _BEFORE, "proto/envelope.proto": _ENVELOPE.replace("imu = 1", "imu = 2")}, tmp_path)
    found = project()
    assert [one for one in found if one["name"] == "buf-breaking" and one["message_type"] == "Envelope"] == []
    assert any(one["id"].startswith("ENV") for one in found)


# --- without buf, and with one that fails ---


def test_buf_is_not_there(lint: Run, run: Run, other_bin: Path) -> None:
    """Without --against there is nothing for buf to compare; without buf, one message has the command to install it."""
    code, _, err = run("lint", "after", "--with-buf")
    assert (code, "--with-buf compares two states; name the earlier state with --against" in err) == (2, True)
    assert lint() == (
        2,
        "--with-buf: fatal[BUF101] buf is not installed beside this Python interpreter or on the PATH; "
        "nothing was linted\n"
        f"  help: {other_bin}/python -m pip install buf-bin\n\n"
        "1 fatal error\n",
        "",
    )


_FAILURES = {
    "it fails": ("#!/bin/sh\necho 'Failure: out of luck' >&2\nexit 1\n", "Failure: out of luck"),
    "it fails in silence": ("#!/bin/sh\nexit 3\n", "exit code 3"),
    "it names nothing": ("#!/bin/sh\nexit 100\n", "exit code 100"),
    "it crashes": ("#!/bin/sh\nkill -9 $$\n", "exit code -9"),
    "it is something else": ("#!/bin/sh\necho 'Usage: buf FILE'\n", "not a list of findings: Usage: buf FILE"),
    "not a finding": ("#!/bin/sh\necho '{\"say\": 1}'\nexit 100\n", 'not a list of findings: {"say": 1}'),
    "not an object": ("#!/bin/sh\necho 7\nexit 100\n", "not a list of findings: 7"),
    "no rule": ('#!/bin/sh\necho \'{"type": "COMPILE", "message": "no"}\'\nexit 100\n', "not a list of findings"),
    "no text": ("#!/bin/sh\nprintf '\\377\\376\\n'\nexit 100\n", "not a list of findings"),
    "no program": ("", "it cannot be run: "),
}


@pytest.mark.parametrize("stub", _FAILURES)
def test_buf_fails(lint: Run, other_bin: Path, stub: str) -> None:
    """That is one finding and exit code 2; our own findings are shown all the same."""
    program, why = _FAILURES[stub]
    _executable(other_bin / "buf", program)
    code, out, err = lint("--format", "json")
    [failure, *ours] = json.loads(out)
    assert (code, err, failure["id"], failure["severity"]) == (2, "", "BUF102", "fatal")
    assert failure["message"].startswith(f"{other_bin}/buf did not compare the two states: ")
    assert why in failure["message"]
    assert failure["help"] == f"if this buf is old or broken: {other_bin}/python -m pip install --upgrade buf-bin"
    assert [finding["id"] for finding in ours] == ["WIR102", "WIR101"]


# --- beside buf by itself ---


_ALONE = {"package_changed", "no_package"}
"""Mutations that say what they say only by themselves."""
_SOURCE_AND_JSON = {
    *("ENUM_NO_DELETE", "ENUM_SAME_JSON_FORMAT", "ENUM_SAME_TYPE", "ENUM_VALUE_NO_DELETE", "ENUM_VALUE_SAME_NAME"),
    *("EXTENSION_MESSAGE_NO_DELETE", "EXTENSION_NO_DELETE", "FIELD_NO_DELETE", "FIELD_SAME_CARDINALITY"),
    *("FIELD_SAME_CPP_STRING_TYPE", "FIELD_SAME_JAVA_UTF8_VALIDATION", "FIELD_SAME_JSON_NAME", "FIELD_SAME_JSTYPE"),
    *("FIELD_SAME_NAME", "FIELD_SAME_ONEOF", "FIELD_SAME_TYPE", "FIELD_SAME_UTF8_VALIDATION", "FILE_NO_DELETE"),
    *("MESSAGE_NO_DELETE", "MESSAGE_NO_REMOVE_STANDARD_DESCRIPTOR_ACCESSOR", "MESSAGE_SAME_JSON_FORMAT"),
    *("ONEOF_NO_DELETE", "RESERVED_ENUM_NO_DELETE", "RESERVED_MESSAGE_NO_DELETE"),
}
"""Rules of buf's that find what ours do not."""


@pytest.mark.slow
@needs_buf
def test_nothing_of_bufs_is_lost(tmp_path: Path) -> None:
    """What buf finds in files that it compiles itself is shown, but for what ours say of the same line."""
    alone = [mutation for mutation in MUTATIONS if mutation.name in _ALONE]
    rest = together([mutation for mutation in MUTATIONS if mutation not in alone])
    for mutation in (*alone, rest):
        before, after = tmp_path / mutation.name / "before", tmp_path / mutation.name / "after"
        states = compiled(mutation.before, before), compiled(mutation.after, after)
        found = breaking(*states, ROOT)
        by_itself = [
            one for one in buf.breaking(before, after, ["FILE"]) if not _is_of_an_entry(one.message, states[0])
        ]
        places = {(one.rule.id, one.span.file.removeprefix(ROOT).lstrip("/"), one.span.line or 1) for one in found}
        assert places == {(one.rule, one.path, one.line) for one in by_itself}
        ours = changes_found(*states)
        shown = set(unstated(found, ours))
        dropped = [one for one in found if one not in shown]
        lines = {(one.span.file, one.span.line) for one in ours}
        numbers = [(one.span.file, f'"{one.number}"') for one in ours]
        for one in dropped:
            of_number = any(one.span.file == file and number in one.message for file, number in numbers)
            assert of_number or (one.span.file, one.span.line) in lines, one.render()
        assert {one.rule.id for one in shown} >= _SOURCE_AND_JSON if mutation is rest else shown


def _is_of_an_entry(message: str, before: Schema) -> bool:
    """Whether a finding says that the entry of a map was deleted, which nobody wrote."""
    deleted = re.fullmatch(r'Previously present message "(.*)" was deleted from file.', message)
    entries = [name for name, message in before.messages.items() if message.map_entry]
    return deleted is not None and any(f".{name}".endswith(f".{deleted[1]}") for name in entries)
