"""What became of a schema, where buf has nothing to say: meanings, units, the ledger; and what holds for any schema."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from comparing import FAMILY, TABLE, case_table, changes_found, compiled, found
from golden_lint_cases import LintCase, lint_cases
from mutations import BASE, MUTATIONS

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.lint.comparison import SchemaChange
from roverlink.generator.lint.context import Context
from roverlink.generator.lock import Ledger, read
from roverlink.generator.protos.number_ranges import spelled
from roverlink.generator.protos.parser import parse
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema

CASES = case_table("""
only_a_number_in_common | message A { float wheel_1 = 1; }
WIR114 1 | message A { float arm_1 = 1; }
only_a_unit_in_common | message A { float reach_mm = 1; }
WIR114 1 | message A { float width_mm = 1; }
json_name_as_the_name_was | message A { float motor_voltage = 1; }
- | message A { float supply = 1 [json_name = "motor_voltage"]; }
another_type_as_well | message A { float volts = 1; }
WIR101 1 | message A { string title = 1; }
unit | message A { int32 reach_mm = 1; }
WIR115 1 | message A { int32 reach_m = 1; }
unit_in_camel_case | message A { int32 reachMm = 1; }
WIR115 1 | message A { int32 reachCm = 1; }
share | message A { float duty_ratio = 1; }
WIR115 1 | message A { float duty_percent = 1; }
scale | message A { int32 angle_x100 = 1; }
WIR115 1 | message A { int32 angle_x10 = 1; }
relative | message A { float position = 1; }
WIR115 1 | message A { float delta_position = 1; }
rate | message A { float angle_deg = 1; }
WIR115 1 | message A { float angle_deg_per_s = 1; }
content_replaced | message A { float voltage = 1; float current = 2; int32 load = 3; }
WIR101 1, WIR101 2, WIR101 3, WIR113 None | message A { string text = 1; bytes blob = 2; A inner = 3; }
a_third_left | message A { float voltage = 1; float current = 2; int32 load = 3; }
WIR101 2, WIR101 3 | message A { float voltage = 1; bytes blob = 2; A inner = 3; }
retyped_only | message A { float voltage = 1; float current = 2; int32 load = 3; }
WIR101 1, WIR101 2, WIR101 3 | message A { double voltage = 1; double current = 2; sint32 load = 3; }
emptied | message A { float voltage = 1; float current = 2; int32 load = 3; }
WIR102 1, WIR102 2, WIR102 3 | message A { int32 state = 4; }
message_of_other_names | message A { float x = 1; } message B { float y = 1; } message C { A a = 1; }
WIR114 1 | message A { float x = 1; } message B { float y = 1; } message C { B a = 1; }
message_that_lacks_a_field | message A { float x = 1; float y = 2; } message B { float x = 1; } message C { A a = 1; }
WIR101 1 | message A { float x = 1; float y = 2; } message B { float x = 1; } message C { B a = 1; }
message_with_itself_inside | message Tree { Tree child = 1; } message C { Tree root = 1; }
- | message Branch { Branch child = 1; } message C { Branch root = 1; }
map_of_another_type_with_a_number_of_its_own | message A { map<string, int32> counts = 1; }
- | message A { map<string, float> counts = 2; reserved 1; }
map_renamed | message A { map<string, int32> item_counts = 1; }
- | message A { map<string, int32> counts = 1; }
integer_to_enum | enum E { E_NO = 0; } message A { uint32 mode = 1; }
- | enum E { E_NO = 0; } message A { E mode = 1; }
into_a_oneof_alone | message A { int32 x = 1; }
- | message A { oneof o { int32 x = 1; } }
into_a_oneof_with_new_ones | message A { int32 x = 1; }
- | message A { oneof o { int32 x = 1; int32 y = 2; } }
edition_requires | edition = "2023"; message A { int32 x = 1; }
WIR104 2 | edition = "2023"; message A { int32 x = 1; int32 y = 2 [features.field_presence = LEGACY_REQUIRED]; }
""")
"""The findings of each case are written as "ID number"."""


def _state(name: str, body: str) -> str:
    head, _, rest = body.partition(";") if body.startswith("edition") else ('syntax = "proto3"', ";", body)
    return f"{head};\npackage {name};\n{rest}\n"


@pytest.fixture(scope="module")
def found_in_cases(tmp_path_factory: pytest.TempPathFactory) -> list[Diagnostic]:
    """What is found in all cases, each of which has a file and a package of its name."""
    states = [{f"{name}.proto": _state(name, case[side]) for name, case in CASES.items()} for side in (0, 1)]
    before, after = (compiled(state, tmp_path_factory.mktemp("state")) for state in states)
    return changes_found(before, after)


@pytest.mark.parametrize("name", CASES)
def test_case(name: str, found_in_cases: list[Diagnostic]) -> None:
    """Each case has the findings that it says, and no others."""
    ours = [finding for finding in found_in_cases if finding.type.startswith(f"{name}.")]
    assert ", ".join(sorted(f"{finding.rule.id} {finding.number}" for finding in ours)) == CASES[name][2]


def test_what_is_said_of_units(found_in_cases: list[Diagnostic]) -> None:
    """Where the factor is known, the message says by how much a receiver is off."""
    said = {finding.type.split(".")[0]: finding.message for finding in found_in_cases if finding.rule.id == "WIR115"}
    said = {name: message.partition(": ")[2] for name, message in said.items()}
    assert said["unit"] == "old values (mm) are read as m, 1000 times too large"
    assert said["scale"] == "old values (times 100) are read as times 10, 10 times too large"
    assert said["relative"] == "old values (the plain value) are read as relative"


# --- the ledger ---


def _as_ledger(schema: Schema) -> Schema:
    """A schema as the ledger knows it."""
    return dataclasses.replace(
        schema,
        files=(),
        extensions=(),
        messages={name: _message_of_ledger(message) for name, message in schema.messages.items()},
        enums={
            name: dataclasses.replace(enum, file="", places={}, span=Span("mapping.lock", 9))
            for name, enum in schema.enums.items()
        },
    )


def _message_of_ledger(message: ProtoMessage) -> ProtoMessage:
    fields = tuple(map(_field_of_ledger, message.fields))
    known = dataclasses.replace(message, file="", fields=fields, map_entry=False, extension_ranges=(), facets={})
    return dataclasses.replace(known, places={}, span=Span("mapping.lock", 9))


def _field_of_ledger(field: ProtoField) -> ProtoField:
    type = "message" if field.type == "group" else field.type
    known = dataclasses.replace(field, type=type, declared_optional=False, json_name="", facets={})
    return dataclasses.replace(known, places={}, span=Span("mapping.lock", 9))


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Schema:
    """The states' schema."""
    return compiled(BASE, tmp_path_factory.mktemp("base"))


def test_a_schema_is_like_itself(base: Schema) -> None:
    """Nothing is found against the very same, nor against what the ledger knows of it."""
    assert changes_found(base, base) == []
    assert changes_found([SchemaChange(_as_ledger(base), base, of_ledger=True)], base) == []


@pytest.mark.slow
def test_a_fault_against_two_states_comes_once(tmp_path: Path) -> None:
    """What the ledger and another state both know is said once, with that state's place."""
    chosen = ("int32_to_string", "field_deleted", "value_deleted")
    for mutation in (one for one in MUTATIONS if one.name in chosen):
        before = compiled(mutation.before, tmp_path / mutation.name / "before", "earlier")
        after = compiled(mutation.after, tmp_path / mutation.name / "after")
        ledger = SchemaChange(_as_ledger(before), after, of_ledger=True)
        [finding] = changes_found([ledger, SchemaChange(before, after)], after)
        assert finding.also[0][0].file.startswith("earlier/")
        [alone] = changes_found([ledger], after)
        assert alone == dataclasses.replace(finding, also=())


def _ledger(folder: Path, type: str, *lines: str) -> Ledger:
    """A ledger whose schema has a message or an enum with these lines."""
    path = folder / "mapping.lock"
    path.write_text("\n".join(["schema:", f"  {type}:", *(f"    {line}" for line in lines)]), encoding="utf-8")
    return read(path, [])


@pytest.mark.parametrize(
    ("lines", "field", "reused"),
    [
        (["2 level int32 gone"], "float volume = 2;", True),
        (["2 level int32 gone"], "string level = 2;", True),
        (["2 level int32 gone"], "int32 level = 2;", False),
        (["2 level int32 gone"], "int64 level = 2;", False),
        (["2 level int32 gone"], "float volume = 3;", False),
        (["2 level int32"], "float volume = 2;", False),  # never gone: the change itself is found
        (["2 volume float", "2 level int32 gone"], "float volume = 2;", False),
        (["2 level int32 gone"], "int32 water_level = 2;", False),
    ],
)
def test_reuse_after_a_gap(lines: list[str], field: str, reused: bool, tmp_path: Path) -> None:
    """A number that is gone in the ledger is not given to another field; one with a similar name is the same."""
    schema = compiled({"a.proto": f'syntax = "proto3"; message A {{ {field} }}'}, tmp_path)
    published = _ledger(tmp_path, "message A", *lines)
    ids = [finding.rule.id for finding in found(Context(TABLE, schema, published))]
    assert ids == ["WIR111"] * reused


@pytest.mark.parametrize(
    ("gone", "field", "id"),
    [("speed float", "float velocity = 2;", "WIR116"), ("reach_mm int32", "int32 reach_m = 2;", "WIR115")],
)
def test_doubts_after_a_gap(gone: str, field: str, id: str, tmp_path: Path) -> None:
    """Where the name of a deleted field leaves a doubt, that is a warning, as it is between two states."""
    schema = compiled({"a.proto": f'syntax = "proto3"; message A {{ {field} }}'}, tmp_path)
    published = _ledger(tmp_path, "message A", f"2 {gone} gone")
    [finding] = found(Context(TABLE, schema, published))
    assert (finding.rule.id, finding.number) == (id, 2)


def test_reuse_of_an_enum_number_after_a_gap(tmp_path: Path) -> None:
    """The same holds for the numbers of an enum, whatever names they have beside."""
    text = 'syntax = "proto3"; enum E { A = 0; B = 1; C = 2; D = 3; }'
    schema = compiled({"a.proto": text}, tmp_path)
    published = _ledger(tmp_path, "enum E", "3 OLDER", "1 PARK gone", "2 C gone")
    [finding] = found(Context(TABLE, schema, published))
    assert (finding.rule.id, finding.number) == ("WIR112", 1)
    assert finding.help == 'write `B = 4; reserved 1; reserved "PARK";`: the number 4 is free'


def test_the_next_free_number(tmp_path: Path) -> None:
    """It is above what is declared, reserved, in a comment, or known to the ledger."""
    text = 'syntax = "proto3";\nmessage A {\n  string speed = 1;\n  // int32 later = 7;\n  reserved 9 to 11;\n}\n'
    before = compiled({"a.proto": text.replace("string", "int32")}, tmp_path / "before")
    after = compiled({"a.proto": text}, tmp_path / "after")
    context = Context(TABLE, after, Ledger(), {"a.proto": parse(text)}, changes=(SchemaChange(before, after),))
    [finding] = found(context)
    assert finding.help == (
        "put back `int32 speed = 1;`; or give it the free number 8: `string speed = 8; reserved 1;`"
    )
    [finding] = found(dataclasses.replace(context, ledger=_ledger(tmp_path, "message A", "8 gone int32 gone")))
    assert "free number 12:" in finding.help


# --- what holds for any ---


def test_ranges_as_they_are_written() -> None:
    """One number stands alone, and the largest is `max`."""
    assert spelled([(3, 3), (5, 9), (1000, 2**29 - 1)]) == "3, 5 to 9, 1000 to max"


# --- what is to be written instead ---

_OF_CHANGES = [case for case in lint_cases() if "before" in case.entry]
_BAD = [case for case in _OF_CHANGES if case.name.startswith(FAMILY) and "_bad_" in case.name]
_SAID = re.compile(r"(?P<verb>remove )?`(?P<code>[^`]+;)`(?P<rest>[^`]*)")
_ELSEWHERE = ("import ", "syntax ", "edition ", "extend ")
_NOT_ALONE = (" for the whole file", " in place of message", " with its type")
_NAMED = re.compile(r"(\w+) = (-?\d+)")


def _files_of(folder: Path) -> dict[str, str]:
    return {path.relative_to(folder).as_posix(): path.read_text() for path in sorted(folder.rglob("*.proto"))}


def _cured(files: dict[str, str], schema: Schema, finding: Diagnostic) -> Iterator[dict[str, str]]:
    """The files with each of the statements that a help says, in the type that it is about."""
    about = schema.messages.get(finding.type)
    owner = finding.type.rpartition(".")[0] if about and about.map_entry else finding.type
    declared = schema.messages.get(owner) or schema.enums.get(owner)
    extensions = [(one.extendee, one.field.number) for one in schema.extensions]
    help = re.sub(r"`, and give [^`]*`", " ", finding.help)  # the two belong together
    for said in _SAID.finditer(help):
        code, rest = said["code"], said["rest"]
        outside = code.startswith(_ELSEWHERE) or rest.startswith(_NOT_ALONE)
        if declared and not outside and not said["verb"] and (finding.type, finding.number) not in extensions:
            text = files[declared.file]
            start = re.search(rf"^ *(message|enum) {owner.rpartition('.')[2]} \{{\n", text, re.MULTILINE)
            assert start, finding
            end = text.index("\n}", start.end())
            inside = _without(text[start.end() : end], code, "in place of" in rest, finding.help)
            yield files | {declared.file: f"{text[: start.end()]}{inside}\n{code}{text[end:]}"}


def _without(inside: str, code: str, in_place: bool, help: str) -> str:
    """The lines of a type, but for those that are moved, replaced or said to go."""
    names = {name for name, _ in _NAMED.findall(code)}
    names |= set(re.findall(r"call (\w+) = ", help))
    numbers = set() if "allow_alias" in code else {number for _, number in _NAMED.findall(code)}
    kept = []
    for line in inside.split("\n"):
        declared = _NAMED.search(line)
        replaced = declared and (declared[1] in names or declared[2] in numbers)
        if not (replaced or (in_place and "reserved" in line) or ("features" in code and "features" in line)):
            kept.append(line)
    return "\n".join(kept)


@pytest.mark.slow
@pytest.mark.parametrize("case", _BAD, ids=lambda case: case.name)
def test_what_is_to_be_written(case: LintCase, tmp_path: Path) -> None:
    """Each statement that a help says compiles where it is to be written, and cures without doing other harm."""
    root = case.write(tmp_path / "case")
    files = _files_of(root / "proto")
    before, after = compiled(_files_of(root / "before"), tmp_path / "before"), compiled(files, tmp_path / "after")
    for count, finding in enumerate(changes_found(before, after)):
        for number, cured in enumerate(_cured(files, after, finding)):
            left = changes_found(before, compiled(cured, tmp_path / f"{count}_{number}"))
            harm = {one.rule.id for one in left if (one.type, one.number) == (finding.type, finding.number)}
            assert not harm, f"{finding.help}\n{cured}"
