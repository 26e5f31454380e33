"""docs/messages.md, as its readers use it: bytes that decode, links that lead somewhere, units, the diagram."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from case_file import CaseFile
from golden import PROBE_TABLE, compiled, files_of, generate, passing_cases
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass

_TABLE = PROBE_TABLE.partition("messages:")[0] + "targets: [markdown]\nmessages:\n"
_ROW = "  - {number: %d, name: %s, proto: %s, topic: %s, direction: board_to_ros%s}\n"
_EXAMPLE = re.compile(
    r"Example: a payload of (?P<payload>\d+) bytes in a datagram of (?P<datagram>\d+) bytes\.\n\n"
    r"```text\n(?P<lines>.*?)```",
    re.DOTALL,
)


def _sections(page: str) -> dict[str, str]:
    """The sections of rows, by the row's name."""
    parts = re.split(r"^## (?:\d+: (\w+)|[^\n]*)$", page, flags=re.MULTILINE)
    return {name: text for name, text in zip(parts[1::2], parts[2::2]) if name}


def _example(section: str) -> tuple[bytes, int, int]:
    """The datagram of an example, and the sizes that the page tells."""
    found = _EXAMPLE.search(section)
    assert found is not None
    data = "".join(re.match(r"(?:[0-9a-f]{2}(?: |$))*", line)[0] for line in found["lines"].splitlines())  # type: ignore[index]  # it may match nothing
    return bytes.fromhex(data), int(found["payload"]), int(found["datagram"])


def _page(tmp_path: Path, rows: str, proto: str) -> str:
    (tmp_path / "proto").mkdir()
    (tmp_path / "mapping.yaml").write_text(_TABLE + rows)
    (tmp_path / "proto" / "board.proto").write_text(f'syntax = "proto3";\n{proto}')
    outcome = generate(tmp_path)
    assert (outcome.code, outcome.stderr) == (0, "")
    return (tmp_path / "docs" / "messages.md").read_text(encoding="utf-8")


def _with_pages() -> list[CaseFile]:
    """The passing cases whose targets, named or usual, have the page."""
    tables = ((case, case.inputs["mapping.yaml"]) for case in passing_cases())
    return [case for case, table in tables if b"\ntargets:" not in table or b" markdown" in table]


_DIFFER_MOST = {
    *("any_of", "comments", "cpp_handlers", "deprecated", "empty_messages", "enums", "extensions", "maps"),
    *("nanopb_options", "nested", "oneofs", "presence", "retired", "scalars", "signing", "standard_units"),
}
_PAGES = [
    pytest.param(case, marks=[] if case.name in _DIFFER_MOST else [pytest.mark.slow], id=case.name)
    for case in _with_pages()
]


@pytest.mark.parametrize("case", _PAGES)
def test_the_bytes_of_examples_decode_and_links_lead_to_headings(case: CaseFile) -> None:
    """The bytes of each example are an envelope with the row's payload; every link leads to one heading of the page."""
    bridge, page = compiled(case).bridge, files_of(case)["docs/messages.md"]
    pool = DescriptorPool()
    for file in FileDescriptorSet.FromString(bridge.descriptors).file:
        pool.Add(file)
    envelope_type: Any = GetMessageClass(pool.FindMessageTypeByName(bridge.envelope.message))
    sections = _sections(page)
    assert [*sections] == [route.name for route in bridge.routes]
    for route in bridge.routes:
        data, payload, datagram = _example(sections[route.name])
        envelope = envelope_type()
        envelope.MergeFromString(data)
        assert envelope.WhichOneof(bridge.envelope.oneof) == route.name
        assert (getattr(envelope, route.name).ByteSize(), len(data)) == (payload, datagram)
    headings = re.findall(r"^#+ (.*)$", page, re.MULTILINE)
    anchors = Counter(re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings)
    links = set(re.findall(r"\]\(#([^)]*)\)", page))
    assert {link: anchors[link] for link in links} == dict.fromkeys(links, 1)


def test_units_come_from_the_table_and_from_comments(tmp_path: Path) -> None:
    """A unit in brackets moves from the comment to its column; the table's unit goes before it."""
    also = (
        "{topic: t, ros: sensor_msgs/Temperature, frame_id: f, fields: {temperature: {from: inner.heat, unit: degF}}}"
    )
    page = _page(
        tmp_path,
        _ROW % (1, "probe", "Probe", "probe", f", also: [{also}]"),
        "message Inner {\n  float heat = 1;  // Heat [degC].\n}\n"
        "message Probe {\n  float speed = 1;  // Speed over ground [km/h].\n  float share = 2;  // Between [0, 1].\n"
        "  float level = 3;  // [V]\n  Inner inner = 4;\n}\n",
    )
    assert "| 1 | `speed` | `float` | km/h | `float32 speed` | Speed over ground. |" in page
    assert "| 2 | `share` | `float` |  | `float32 share` | Between [0, 1]. |" in page
    assert "| 3 | `level` | `float` | V | `float32 level` |  |" in page
    assert "| 1 | `heat` | `float` | degF | `float32 heat` | Heat. |" in page


def test_the_diagram_stays_small(tmp_path: Path) -> None:
    """A group with many rows shows the first twelve, and counts the others."""
    rows = "".join(_ROW % (n, f"r{n}", f"M{n}", f"t{n}", "") for n in range(1, 16))
    page = _page(tmp_path, rows, "".join(f"message M{n} {{}}\n" for n in range(1, 16)))
    assert 'rows_0["1 r1<br>' in page
    assert '<br>12 r12<br>and 3 more"]' in page
