"""docs/conversions.md shows what generate makes."""

from __future__ import annotations

from pathlib import Path

from page import ROOT, blocks

from roverlink.generator.pipeline import compile_table

_PAGE = ROOT / "docs" / "conversions.md"
_TABLE = """\
version: 1
proto: {root: proto}
envelope: {file: envelope.proto, message: Envelope, oneof: payload}
ros: {package: probe_msgs}
peers: {drill: {}}
messages:
  - {number: 1, name: survey, proto: Survey, topic: survey, direction: drill_to_ros, presence: {started: true}}
"""


def test_the_example_is_what_generate_writes(tmp_path: Path) -> None:
    """The proto on the page becomes the message on the page, and those that it names beside it."""
    shown = {block.language: block.text for block in blocks(_PAGE)}
    (tmp_path / "proto").mkdir()
    (tmp_path / "proto" / "survey.proto").write_text(shown["proto"], encoding="utf-8")
    (tmp_path / "mapping.yaml").write_text(_TABLE, encoding="utf-8")

    files = compile_table(tmp_path / "mapping.yaml").files

    folder = "generated/ros/probe_msgs/msg"
    assert files[f"{folder}/Survey.msg"].partition("\n\n")[2] == shown["text"]
    assert {path for path in files if path.endswith(".msg")} == {
        f"{folder}/{name}.msg" for name in ("Bytes", "Survey", "SurveyDepthsEntry")
    }
