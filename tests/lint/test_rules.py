"""The rules where the cases do not reach: half tables, trees without one, what is known twice, and edges of each."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from pathlib import Path

import pytest

from roverlink.generator.diagnostics import Diagnostic, Severity, Span
from roverlink.generator.lint import bare_tree
from roverlink.generator.lint.comparison import SchemaChange
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.engine import lint
from roverlink.generator.lock import Entry, Ledger
from roverlink.generator.nanopb import Bounds, FieldBounds
from roverlink.generator.protos.parser import parse
from roverlink.generator.protos.protoc import compile_tree
from roverlink.generator.protos.schema import Schema
from roverlink.generator.table import Table, reader

_HEAD = """\
version: 1
proto: {root: proto}
envelope: {file: envelope.proto, message: Envelope, oneof: payload, owner: OWNER}
ros: {package: rover}
peers: {board: {prefixes: [Board]}, base: {prefixes: [Base], max_size: 32}, spare: {}}
messages:
"""
_IMU = "  - {number: 1, name: imu, proto: Imu, topic: imu, direction: spare_to_ros}\n"
_GPS = "  - {number: 2, name: gps, proto: Gps, topic: gps, direction: spare_to_ros}\n"
_PAYLOADS = 'syntax = "proto3";\nmessage Imu { float x = 1; }\nmessage Gps { float x = 1; }\n'


def _table(folder: Path, rows: str, more: str = "", owner: str = "mapping") -> Table:
    path = folder / "mapping.yaml"
    path.write_text(_HEAD.replace("OWNER", owner) + rows + more, encoding="utf-8")
    return reader.read(path, [], "mapping.yaml")


def _schema(folder: Path, files: Mapping[str, str], shown_root: str = "proto") -> Schema:
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    return compile_tree(folder, sorted(files), shown_root)[0]


def _envelope(*members: str, outside: str = "") -> str:
    oneof = f"oneof payload {{\n{' '.join(members)}\n}}"
    return f'syntax = "proto3";\nimport "payloads.proto";\nmessage Envelope {{\n{oneof}\n{outside}\n}}\n'


def _published(*entries: tuple[int, str, str], topic: str = "", file: str = "mapping.lock") -> tuple[Entry, ...]:
    return tuple(
        Entry(number, name, proto, topic, False, False, Span(file, line, 3))
        for line, (number, name, proto) in enumerate(entries, 5)
    )


def _found(context: Context, *ids: str) -> list[Diagnostic]:
    return [finding for finding in lint(context) if finding.rule.id in ids]


def _said(context: Context, *ids: str) -> list[str]:
    return [f"{finding.span} {finding.message}" for finding in _found(context, *ids)]


# --- half a table, and none ---


def test_nothing_is_concluded_from_a_table_that_is_not_whole(tmp_path: Path) -> None:
    """What is missing may stand in the part that could not be read: no number, prefix or peer is missed then."""
    rows = "  - {number: 1, name: imu, proto: BaseImu, topic: imu, direction: board_to_ros}\n  - {name: odd}\n"
    table = _table(tmp_path, rows + "  - {number: 3, name: gps, proto: Gps, topic: gps, direction: board_to_ros}\n")
    context = Context(table, Schema(), Ledger(_published((2, "wind", "Wind"))))
    whole = dataclasses.replace(context, table=dataclasses.replace(table, whole=True))
    assert not table.whole
    assert _said(context, "ENV103", "TAB103", "TAB105", "NAM102") == []
    assert {finding.rule.id for finding in _found(whole, "ENV103", "TAB105", "NAM102")} == {
        "ENV103",
        "TAB105",
        "NAM102",
    }


def _base(entries: Iterable[Entry]) -> Context:
    """An earlier state with payloads in its ledger."""
    return Context(bare_tree.table_of_tree(bare_tree.TreeOptions("", "")), Schema(), Ledger(tuple(entries)))


def test_the_envelope_of_a_tree_is_looked_at_as_a_table_is(tmp_path: Path) -> None:
    """Its members are rows: their reuse, their free numbers and payloads beside the oneof are found.

    What has no topic and no direction cannot have a wrong one.
    """
    outside = "Gps lost = 9; uint32 sequence = 100;"
    files = {"payloads.proto": _PAYLOADS, "envelope.proto": _envelope("Imu imu = 1;", "Imu wind = 3;", outside=outside)}
    schema = _schema(tmp_path, files, "")
    name = bare_tree.TreeOptions("envelope.proto", "Envelope")
    table = bare_tree.with_members(bare_tree.table_of_tree(name), schema)
    before = _published((1, "imu", "Imu"), (2, "gps", "Gps"), (3, "wind", "Wind"), file="before/envelope.proto")
    parsed = {path: parse(text) for path, text in files.items()}
    found = lint(Context(table, schema, Ledger(), parsed, base=_base(before)))
    assert [(str(finding.span), finding.rule.id, finding.number) for finding in found] == [
        ("envelope.proto:5:25", "ENV102", 3),
        ("envelope.proto:7:1", "ENV106", 9),
        ("envelope.proto:3:9", "ENV107", 2),
    ]


# --- what was published ---


def test_one_fact_from_three_places_is_one_fault(tmp_path: Path) -> None:
    """The earlier state's ledger, table and envelope all know a number; so does this ledger, which is named."""
    table = _table(tmp_path, _IMU + "  - {number: 2, name: wind, proto: Wind, topic: wind, direction: spare_to_ros}\n")
    gone = ((2, "gps", "Gps"), (3, "heat", "Heat"))
    earlier = [entry for file in ("mapping.lock", "mapping.yaml", "e.proto") for entry in _published(*gone, file=file)]
    context = Context(table, Schema(), Ledger(_published(*gone)), base=_base(earlier))
    assert _said(context, "ENV102", "ENV103") == [
        "mapping.yaml:8:14 field 2 was published for 'gps' (Gps), but is given to Wind here",
        "mapping.lock:6:3 field 3 was published as 'heat' (Heat), but is missing in mapping.yaml",
    ]


def test_an_earlier_state_is_not_where_a_number_is_missing(tmp_path: Path) -> None:
    """Nobody can mend the earlier state: the finding stands at the table, and names the place there."""
    earlier = _published((2, "gps", "Gps"), file="before/mapping.yaml")
    (finding,) = _found(Context(_table(tmp_path, _IMU), Schema(), Ledger(), base=_base(earlier)), "ENV103")
    assert str(finding.span) == "mapping.yaml"
    assert finding.also == ((Span("before/mapping.yaml", 5, 3), "published here"),)


def test_the_topics_of_a_row_are_said_once(tmp_path: Path) -> None:
    """A topic that ledger and earlier state both know is one; another payload's is not the row's; empty is unknown."""
    table = _table(tmp_path, _IMU + _GPS)
    old = _published((1, "imu", "Imu"), (2, "wind", "Wind"), topic="old")
    older = (*old, *_published((1, "imu", "Imu"), topic="older"), *_published((1, "imu", "Imu")))
    said = _said(Context(table, Schema(), Ledger(old), base=_base(older)), "TAB107")
    assert said == ["mapping.yaml:7:47 'imu' has the topic 'imu'; it was published on 'old' and on 'older'"]


# --- numbers ---


@pytest.mark.parametrize(
    ("numbers", "published", "hinted"),
    [
        ((1, 2), (1,), []),
        ((1, 3), (1,), ["3 -> 2"]),
        ((1, 4, 3), (1,), ["3 -> 2", "4 -> 3"]),
        ((50, 100), (100,), []),
        ((18_999, 20_000), (18_999,), []),
        ((18_999, 20_001), (18_999,), ["20001 -> 20000"]),
        ((1, 9), (), []),
    ],
)
def test_new_numbers_follow_the_largest_old_one(
    tmp_path: Path, numbers: tuple[int, ...], published: tuple[int, ...], hinted: list[str]
) -> None:
    """Only what lies above every old number is known to be unused, and protobuf's own numbers do not count."""
    rows = "".join(_IMU.replace("1,", f"{n},").replace("name: imu", f"name: imu{n}") for n in numbers)
    ledger = Ledger(_published(*((n, f"imu{n}", "Imu") for n in published)))
    found = _found(Context(_table(tmp_path, rows), Schema(), ledger), "TAB106")
    assert [f"{f.number} -> {f.message.rpartition(' ')[2]}" for f in found] == hinted
    assert {finding.severity for finding in found} <= {Severity.HINT}


# --- the envelope's file ---


def test_our_envelope_is_compared_only_where_it_was_read(tmp_path: Path) -> None:
    """While generating, the envelope on disk is about to be replaced."""
    context = Context(_table(tmp_path, _IMU), Schema(), Ledger())
    assert _said(context, "ENV105") == []
    stale = dataclasses.replace(context, files={"envelope.proto": parse(_envelope("Imu imu = 2;"))})
    assert _said(stale, "ENV105") == ["mapping.yaml:7:14 member 'imu' has the number 2, not 1"]


def test_an_envelope_of_another_owner_that_does_not_compile_is_not_missing(tmp_path: Path) -> None:
    """It is declared; why it does not compile, protoc says."""
    table = _table(tmp_path, _IMU, owner="proto")
    context = Context(table, Schema(), Ledger(), {"envelope.proto": parse(_envelope("Imu imu = 1;"))})
    assert _said(context, "ENV105") == []
    assert len(_said(dataclasses.replace(context, files={"imu.proto": parse("message Imu {}")}), "ENV105")) == 1


@pytest.mark.parametrize(
    ("owner", "field", "found"),
    [
        ("proto", "Imu extra = 9;", True),
        ("proto", "oneof other { Imu extra = 9; }", True),
        ("proto", "uint32 extra = 9;", False),
        ("proto", "google.protobuf.Timestamp extra = 9;", False),
        ("mapping", "uint32 extra = 9;", True),
    ],
)
def test_what_is_a_payload_beside_the_oneof(tmp_path: Path, owner: str, field: str, found: bool) -> None:
    """Another owner's envelope may have a sequence number or a time; in ours, there is nothing but the oneof."""
    envelope = _envelope("Imu imu = 1;", outside=field)
    envelope = envelope.replace("import", 'import "google/protobuf/timestamp.proto";\nimport', 1)
    files = {"payloads.proto": _PAYLOADS, "envelope.proto": envelope}
    context = Context(_table(tmp_path, _IMU, owner=owner), _schema(tmp_path / "proto", files), Ledger())
    assert [finding.number for finding in _found(context, "ENV106")] == ([9] if found else [])


@pytest.mark.parametrize(
    ("retired", "reserved", "found"),
    [
        ("", "", ["ENV103"]),
        ("retired:\n  - {number: 2, name: gps, proto: Gps}\n", "", ["ENV107"]),
        ("retired:\n  - {number: 2, name: gps, proto: Gps}\n", "reserved 2 to max;", []),
        ("retired:\n  - {number: 2, name: gps, proto: Gps}\n", "Gps gps = 2;", ["ENV106"]),
    ],
)
def test_a_number_that_is_gone_is_one_fault(tmp_path: Path, retired: str, reserved: str, found: list[str]) -> None:
    """A number that the table does not have is ENV103's; one that it retires must be reserved by who owns the file."""
    files = {"payloads.proto": _PAYLOADS, "envelope.proto": _envelope("Imu imu = 1;", outside=reserved)}
    schema = _schema(tmp_path / "proto", files)
    context = Context(_table(tmp_path, _IMU, retired, "proto"), schema, Ledger(_published((2, "gps", "Gps"))))
    assert [finding.rule.id for finding in _found(context, "ENV103", "ENV105", "ENV106", "ENV107")] == found


# --- names ---


def test_nested_messages_may_share_a_name(tmp_path: Path) -> None:
    """Only what stands in no other message is known by its name alone; each later file is named once."""
    files = {
        "a.proto": "package a; message Status { message State {} }",
        "b.proto": "package b; message Other { message Status {} message State {} }",
        "c.proto": "package c; message Status {}",
        "d.proto": "package d; message Status {}",
    }
    context = Context(_table(tmp_path, _IMU), Schema(), Ledger(), {path: parse(text) for path, text in files.items()})
    found = _found(context, "NAM101")
    assert [(finding.span.file, finding.type) for finding in found] == [
        ("proto/c.proto", "c.Status"),
        ("proto/d.proto", "d.Status"),
    ]
    assert {finding.also[0][0].file for finding in found} == {"proto/a.proto"}


@pytest.mark.parametrize(
    ("enum", "message", "collides"),
    [
        ("enum Kind { Imu = 0; }", "message Imu {}", True),
        ("package a; enum Kind { Imu = 0; }", "package a; message Imu {}", True),
        ("package a; enum Kind { Imu = 0; }", "package b; message Imu {}", False),
        ("message Outer { enum Kind { Imu = 0; } }", "message Imu {}", False),
        ("message Outer { enum Kind { Imu = 0; } message Imu {} }", "", True),
        ("enum Kind { KIND_IMU = 0; }", "message Imu {}", False),
    ],
)
def test_enum_values_are_siblings_of_their_enum(tmp_path: Path, enum: str, message: str, collides: bool) -> None:
    """A value collides with a message of the scope in which its enum stands, in whatever file of the package."""
    files = {"enum.proto": parse(enum), "message.proto": parse(message)}
    context = Context(_table(tmp_path, _IMU), Schema(), Ledger(), files)
    assert [finding.severity for finding in _found(context, "NAM103")] == ([Severity.ERROR] if collides else [])
    excluded = dataclasses.replace(context, files={}, excluded_files=files)
    assert [finding.severity for finding in _found(excluded, "NAM103")] == ([Severity.WARNING] if collides else [])


# --- sizes ---

_NOTE = 'syntax = "proto3";\nmessage Note {\n  string text = 1;\n  uint32 count = 2;\n  repeated float more = 3;\n}\n'
_TO_BASE = "  - {number: 1, name: note, proto: Note, topic: note, direction: ros_to_base}\n"


def _sized(folder: Path, rows: str, bounds: Mapping[str, FieldBounds], outside: str = "") -> Context:
    files = {"payloads.proto": _NOTE, "envelope.proto": _envelope("Note note = 1;", outside=outside)}
    given = Bounds(fields={("Note", name): bound for name, bound in bounds.items()})
    return Context(_table(folder, rows), _schema(folder / "proto", files), Ledger(), bounds=given)


@pytest.mark.parametrize(
    ("length", "outside", "too_large"), [(12, "", 0), (13, "", 33), (12, "uint32 sequence = 100;", 39)]
)
def test_the_largest_envelope_is_exact(tmp_path: Path, length: int, outside: str, too_large: int) -> None:
    """Tag and length of the payload count, and what stands beside the oneof; 32 bytes fit into 32."""
    bounds = {"text": FieldBounds(max_length=length), "more": FieldBounds(max_count=2)}
    said = _said(_sized(tmp_path, _TO_BASE, bounds, outside), "FIX102")
    assert [message.split(";")[0] for message in said] == (
        [f"mapping.yaml:7:36 envelopes with 'note' have up to {too_large} bytes"] if too_large else []
    )


@pytest.mark.parametrize(
    ("before", "now", "text"),
    [
        ({}, {"text": FieldBounds(max_length=9)}, ""),
        ({"text": FieldBounds(max_size=10)}, {"text": FieldBounds(max_length=9)}, ""),
        ({"text": FieldBounds(max_size=10)}, {}, ""),
        (
            {"text": FieldBounds(max_length=10)},
            {"text": FieldBounds(max_length=9)},
            "text' accepts at most 9 bytes now; it accepted 10 before",
        ),
        (
            {"more": FieldBounds(max_count=3)},
            {"more": FieldBounds(max_count=2)},
            "more' accepts at most 2 values now; it accepted 3 before",
        ),
        (
            {"more": FieldBounds(max_count=3)},
            {"more": FieldBounds(max_count=3, fixed_count=True)},
            "more' accepts exactly 3 values now; it accepted up to 3 before",
        ),
        (
            {"more": FieldBounds(max_count=2, fixed_count=True)},
            {"more": FieldBounds(max_count=3, fixed_count=True)},
            "more' accepts exactly 3 values now; it accepted 2 before",
        ),
        ({}, {"count": FieldBounds(int_size=16)}, "count' accepts 16 bits now; it accepted 32 before"),
        ({"count": FieldBounds(int_size=8)}, {"count": FieldBounds(int_size=16)}, ""),
    ],
)
def test_bounds_that_shrank(
    tmp_path: Path, before: dict[str, FieldBounds], now: dict[str, FieldBounds], text: str
) -> None:
    """Only what was taken before and is refused now; a first bound, and another way to say the same, are none."""
    context = _sized(tmp_path, _TO_BASE, now)
    bounds_before = Bounds(fields={("Note", name): bound for name, bound in before.items()})
    change = SchemaChange(context.schema, context.schema, bounds_before=bounds_before)
    said = [f.message for f in _found(dataclasses.replace(context, changes=(change,)), "FIX103")]
    assert said == ([f"'Note.{text}"] if text else [])
    unknown = dataclasses.replace(change, bounds_before=None)
    assert _found(dataclasses.replace(context, changes=(unknown,)), "FIX103") == []
