"""docs/mapping.md lists the keys and defaults that the generator knows."""

from __future__ import annotations

from pathlib import Path

import committed_tables
from page import ROOT, blocks

from roverlink.generator.pipeline import compile_table
from roverlink.generator.table import Table, reader
from roverlink.generator.table.parts import object_of

_PAGE = ROOT / "docs" / "mapping.md"
_SMALLEST = """\
version: 1
proto: {root: proto}
envelope: {file: envelope.proto, message: Envelope, oneof: payload}
ros: {package: probe_msgs}
peers: {drill: {}}
messages:
  - {number: 1, name: report, proto: ProbeReport, topic: report, direction: drill_to_ros}
"""


def _rows(columns: int) -> list[list[str]]:
    """The cells of every table of the page that has so many columns, without the headings."""
    lines = [line for line in _PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("|")]
    rows = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines if "---" not in line]
    return [row for row in rows if len(row) == columns and row[0] not in ("key", "id")]


def _documented_keys() -> dict[str, str]:
    """Each key of the page, with what stands for its default."""
    return {row[0].strip("`"): row[3] for row in _rows(4) if row[0].startswith("`")}


def test_every_key_of_the_format_is_documented() -> None:
    """The page's tables are made from the declarations of the keys, all of them, each once."""
    page = _PAGE.read_text(encoding="utf-8")

    assert page == committed_tables.current(page), "run: make docs-reference"
    assert sorted(committed_tables.documented_keys(page)) == sorted(object_of(Table).keys)


def test_the_defaults_are_those_of_the_reader(tmp_path: Path) -> None:
    """A table without any optional key reads as the page says."""
    (tmp_path / "mapping.yaml").write_text(_SMALLEST, encoding="utf-8")
    table = reader.read(tmp_path / "mapping.yaml", [])
    row, peer = table.rows[0], table.peers[0]
    documented = {key: default.split(",")[0].strip("`") for key, default in _documented_keys().items()}

    assert documented["envelope.owner"] == table.envelope.owner
    assert documented["peers.<peer>.parameter"] == peer.parameter
    assert documented["peers.<peer>.port"] == str(peer.port)
    assert documented["peers.<peer>.strip_trailing_zeros"] == str(peer.strip_trailing_zeros).lower()
    assert documented["messages[].queue"] == documented["messages[].qos.depth"] == str(row.profile.depth)
    assert documented["messages[].qos.reliability"] == row.profile.reliability
    assert documented["messages[].qos.durability"] == row.profile.durability
    assert documented["messages[].qos.history"] == row.profile.history
    assert documented["messages[].priority"] == str(row.priority)
    assert row.ros == "ProbeReport"
    nothing = {"proto.exclude": table.proto.exclude, "retired": table.retired, "enums": table.enums}
    nothing |= {"messages[].lint": row.lint, "lint": table.lint, "peers.<peer>.max_size": peer.max_size}
    nothing |= {"messages[].deadman": row.deadman, "messages[].max_rate": row.max_rate}
    nothing |= {"messages[].fields": row.fields, "messages[].ignore": row.ignore, "messages[].forward": row.forward}
    assert {key: documented[key] for key in nothing if not nothing[key]} == dict.fromkeys(nothing, "none")


def test_the_example_of_the_conversions_is_what_generate_writes(tmp_path: Path) -> None:
    """The proto on the page becomes the message on the page."""
    shown = {block.language: block.text for block in blocks(_PAGE, "What a proto construct becomes")}
    (tmp_path / "proto").mkdir()
    (tmp_path / "proto" / "probe.proto").write_text(shown["proto"], encoding="utf-8")
    (tmp_path / "mapping.yaml").write_text(_SMALLEST, encoding="utf-8")

    files = compile_table(tmp_path / "mapping.yaml").files

    written = files["generated/ros/probe_msgs/msg/ProbeReport.msg"]
    assert written.partition("\n#\n")[2] == shown["text"]
    assert "generated/ros/probe_msgs/msg/ProbeReportLayer.msg" in files
