"""The forms in which `roverlink lint` says what it found: for people, scripts, GitHub, code scanning, CI servers."""

from __future__ import annotations

import json
from pathlib import Path
from urllib.parse import quote
from xml.etree import ElementTree

import pytest
from case_file import usual_table

from roverlink.__main__ import main
from roverlink.generator.lint.rules import lint_rules

_TABLE = usual_table("""\
envelope: {file: envelope.proto, message: Envelope, oneof: payload, owner: proto}
messages:
  - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
  - {number: 1, name: gps, proto: Gps, topic: gps, direction: board_to_ros}
""")
_ENVELOPE = """\
syntax = "proto3";

import "imu.proto";

message Envelope {
  oneof payload {
    Imu imu = 1;
  }
}
"""


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project with one number given twice, which is the current folder."""
    (tmp_path / "proto").mkdir()
    (tmp_path / "mapping.yaml").write_text(_TABLE)
    (tmp_path / "proto" / "envelope.proto").write_text(_ENVELOPE)
    (tmp_path / "proto" / "imu.proto").write_text('syntax = "proto3";\n\nmessage Imu {}\n\nmessage Gps {}\n')
    monkeypatch.chdir(tmp_path)
    return tmp_path


def _said(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["lint", *arguments]) == 1
    return capsys.readouterr().out


def test_json_has_what_scripts_ask_for(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A list of objects with id, name, severity, type, number, place, message, cure and the other places."""
    found = [finding for finding in json.loads(_said(capsys, "--format", "json")) if finding["id"] == "ENV101"]
    assert found == [
        {
            "id": "ENV101",
            "name": "field-number-taken",
            "severity": "error",
            "known": False,
            "message_type": "Envelope",
            "number": 1,
            "path": "mapping.yaml",
            "line": 8,
            "column": 14,
            "message": "field 1 is already taken by 'imu' (Imu)",
            "help": "use 2, the next number that was never used",
            "history": [],
            "also": [{"path": "mapping.yaml", "line": 7, "column": 14, "text": "first used here", "commit": None}],
        }
    ]


def test_github_is_one_escaped_command_a_finding(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Line breaks and the characters that end a property are escaped, so that each finding is one line."""
    said = _said(capsys, "--format", "github")
    assert (
        "::error file=mapping.yaml,line=8,col=14,title=ENV101 field-number-taken::"
        "field 1 is already taken by 'imu' (Imu)%0Amapping.yaml:7:14: first used here%0A"
        "help: use 2, the next number that was never used\n"
    ) in said
    assert all(line.startswith(("::error ", "::warning ", "::notice ")) for line in said.splitlines())


def test_sarif_names_rules_levels_and_places(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Version 2.1.0: every rule with its documentation, every result with a rule that is there, and its place."""
    log = json.loads(_said(capsys, "--format", "sarif"))
    (run,) = log["runs"]
    rules = {rule["id"]: rule for rule in run["tool"]["driver"]["rules"]}
    assert log["version"] == "2.1.0"
    assert set(lint_rules()) <= set(rules)
    assert rules["ENV101"]["help"]["text"] == lint_rules()["ENV101"].explanation
    assert {result["ruleId"] for result in run["results"]} <= set(rules)
    (result,) = [result for result in run["results"] if result["ruleId"] == "ENV101"]
    assert result["level"] == "error"
    assert result["locations"] == [
        {
            "physicalLocation": {
                "artifactLocation": {"uri": "mapping.yaml"},
                "region": {"startLine": 8, "startColumn": 14},
            }
        }
    ]
    assert result["relatedLocations"][0]["message"] == {"text": "first used here"}


def test_junit_counts_rules_as_tests(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Every rule is a test case; one that found something fails, with all that it found."""
    suite = ElementTree.fromstring(_said(capsys, "--format", "junit"))  # noqa: S314  # our own output
    cases = {str(case.get("name")).split()[0]: case for case in suite}
    assert int(str(suite.get("tests"))) == len(suite) >= len(lint_rules())
    assert int(str(suite.get("failures"))) == sum(case.find("failure") is not None for case in suite)
    failure = cases["ENV101"].find("failure")
    assert failure is not None
    assert "mapping.yaml:8:14: error[ENV101]" in str(failure.text)
    assert cases["ENV104"].find("failure") is None


_STRANGE = ("-x", "@x", "new\nline", "two words::x.proto:1:1: y", "rtl\u202e\x1b[31m")


@pytest.mark.slow
def test_no_format_prints_what_a_terminal_obeys(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Escapes and marks of direction, in names and lines, are shown escaped; each file has the name that it has."""
    paths = [project / "proto" / f"{name}.proto" for name in _STRANGE]
    for letter, path in zip("ABCDM", paths, strict=True):
        path.write_text(f'syntax = "proto3";\n// \f\nmessage {letter} {{ Missing\u202e x = 1; /* \x1b[2J */ }}\n')
    said = {name: _said(capsys, "--format", name) for name in ("text", "github", "junit", "json", "sarif")}
    assert [name for name, text in said.items() if not text.replace("\n", "").isprintable()] == []
    lines = [finding["line"] for finding in json.loads(said["json"]) if finding["path"] == f"proto/{paths[-1].name}"]
    assert set(lines) == {3}
    shown = [f"proto/{name}.proto".encode("unicode_escape").decode() for name in _STRANGE]
    assert [name for name in shown if f"\n{name}:3:20: error[PRO101] " not in said["text"]] == []
    assert "\n3 | message M { Missing\\u202e x = 1; /* \\x1b[2J */ }\n  |                    ^\n" in said["text"]
    failures = "".join(ElementTree.fromstring(said["junit"]).itertext())  # noqa: S314  # our own output
    assert [name for name in shown if f"{name}:3:20: error[PRO101] " not in failures] == []
    assert [name for name in shown if f"file={name.replace(':', '%3A')},line=3,col=20" not in said["github"]] == []
    uris = {
        place["physicalLocation"]["artifactLocation"]["uri"]
        for result in json.loads(said["sarif"])["runs"][0]["results"]
        for place in result["locations"]
    }
    assert {quote(path.relative_to(project).as_posix()) for path in paths} <= uris


@pytest.mark.slow
def test_a_rule_counts_for_as_much_as_the_table_says(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Lowered to a hint, a finding fails no more, but where `--fail-on` asks for it; off, it is gone."""
    (project / "proto" / "envelope.proto").write_text(_ENVELOPE.replace("imu = 1", "imu = 1;\n    Gps gps = 2"))
    one_topic = _TABLE.replace("{number: 1, name: gps", "{number: 2, name: gps").replace("topic: gps", "topic: imu")
    row = "lint: {TAB102: {severity: 'off', reason: for the test}}}"
    tables = {
        "as it is": (one_topic, 1, 1),
        "a hint": (one_topic + "lint: {TAB102: {severity: hint, reason: for the test}}\n", 0, 1),
        "off in the row": (one_topic[:-2] + f", {row}\n", 0, 0),
        "off in another row": (one_topic.replace("board_to_ros}", f"board_to_ros, {row}", 1), 1, 1),
    }
    for name, (table, code, with_hints) in tables.items():
        (project / "mapping.yaml").write_text(table)
        assert main(["lint"]) == code, name
        assert ("TAB102" in capsys.readouterr().out) == bool(with_hints), name
        assert main(["lint", "--fail-on", "hint"]) == with_hints, name
        capsys.readouterr()
