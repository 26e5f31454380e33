"""The mutations are what they are meant to be: states that compile, and among them each rule of buf's broken."""

from __future__ import annotations

from pathlib import Path

import buf
import grpc_tools
import pytest
from buf import needs_buf
from grpc_tools import protoc
from mutations import HARMLESS, MESSAGE_SETS, MUTATIONS, SEVERAL, Mutation, together, write

EXAMPLES = {
    "ENUM_NO_DELETE": "enum_deleted",
    "ENUM_SAME_JSON_FORMAT": "json_best_effort_in_file",
    "ENUM_SAME_TYPE": "enum_closed",
    "ENUM_VALUE_NO_DELETE": "value_deleted_both_reserved",
    "ENUM_VALUE_NO_DELETE_UNLESS_NAME_RESERVED": "value_deleted_number_reserved",
    "ENUM_VALUE_NO_DELETE_UNLESS_NUMBER_RESERVED": "value_deleted_name_reserved",
    "ENUM_VALUE_SAME_NAME": "value_renamed",
    "EXTENSION_MESSAGE_NO_DELETE": "extension_range_lowered",
    "EXTENSION_NO_DELETE": "extension_deleted",
    "FIELD_NO_DELETE": "field_deleted_both_reserved",
    "FIELD_NO_DELETE_UNLESS_NAME_RESERVED": "field_deleted_number_reserved",
    "FIELD_NO_DELETE_UNLESS_NUMBER_RESERVED": "field_deleted_name_reserved",
    "FIELD_SAME_CARDINALITY": "optional_added",
    "FIELD_SAME_CPP_STRING_TYPE": "ctype_added",
    "FIELD_SAME_DEFAULT": "default_changed",
    "FIELD_SAME_JAVA_UTF8_VALIDATION": "java_string_check_utf8_added",
    "FIELD_SAME_JSON_NAME": "json_name_added",
    "FIELD_SAME_JSTYPE": "jstype_changed",
    "FIELD_SAME_NAME": "field_renamed",
    "FIELD_SAME_ONEOF": "moved_into_oneof",
    "FIELD_SAME_TYPE": "int32_to_uint32",
    "FIELD_SAME_UTF8_VALIDATION": "utf8_unverified",
    "FIELD_WIRE_COMPATIBLE_CARDINALITY": "singular_to_repeated",
    "FIELD_WIRE_COMPATIBLE_TYPE": "int32_to_sint32",
    "FIELD_WIRE_JSON_COMPATIBLE_CARDINALITY": "every_cardinality_of_proto3",
    "FIELD_WIRE_JSON_COMPATIBLE_TYPE": "int32_to_int64",
    "FILE_NO_DELETE": "file_renamed",
    "FILE_SAME_SYNTAX": "syntax_changed_to_edition",
    "MESSAGE_NO_DELETE": "message_deleted",
    "MESSAGE_NO_REMOVE_STANDARD_DESCRIPTOR_ACCESSOR": "accessor_removed",
    "MESSAGE_SAME_JSON_FORMAT": "json_of_message_best_effort",
    "MESSAGE_SAME_REQUIRED_FIELDS": "required_added",
    "ONEOF_NO_DELETE": "oneof_renamed",
    "RESERVED_ENUM_NO_DELETE": "enum_reserved_range_shortened",
    "RESERVED_MESSAGE_NO_DELETE": "reserved_range_with_holes",
}
"""For each rule that is ours to match, a mutation that breaks it."""

_WELL_KNOWN = Path(grpc_tools.__file__).parent / "_proto"


def test_names_are_unique() -> None:
    """A name stands for one mutation."""
    names = [mutation.name for mutation in MUTATIONS + MESSAGE_SETS]
    assert sorted(names) == sorted(set(names))


@pytest.mark.slow
def test_every_state_compiles(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """What is before and what is after an edit are both schemas for protoc."""
    states: dict[tuple[tuple[str, str], ...], str] = {}
    for mutation in MUTATIONS + MESSAGE_SETS:
        for side, state in (("before", mutation.before), ("after", mutation.after)):
            states.setdefault(tuple(state.items()), f"{mutation.name}-{side}")
    failed = [name for state, name in states.items() if not _compiles(dict(state), tmp_path / name)]
    assert failed == [], capfd.readouterr().err


def _compiles(state: dict[str, str], folder: Path) -> bool:
    write(state, folder)
    options = [f"-I{folder}", f"-I{_WELL_KNOWN}", f"--descriptor_set_out={folder / 'set'}"]
    return bool(protoc.main(["protoc", *options, *state]) == 0)


@needs_buf
def test_every_rule_in_scope_has_an_example() -> None:
    """No rule that buf has in our categories is left out, nor one invented; services and file options are not ours."""
    ours = {rule for rule, categories in buf.categories_of_rules().items() if categories and not _is_beyond_scope(rule)}
    assert sorted(EXAMPLES) == sorted(ours)


def _is_beyond_scope(rule: str) -> bool:
    return rule.startswith(("SERVICE_", "RPC_", "FILE_SAME_")) and rule != "FILE_SAME_SYNTAX"


@needs_buf
@pytest.mark.slow
def test_every_example_breaks_its_rule(tmp_path: Path) -> None:
    """Buf reports the rule for the mutation that is to break it."""
    by_name = {mutation.name: mutation for mutation in MUTATIONS}
    found = buf.breaking_all([_folders(by_name[name], tmp_path / rule) for rule, name in EXAMPLES.items()])
    broken = {rule for rule, findings in zip(EXAMPLES, found) if rule in {finding.rule for finding in findings}}
    assert sorted(broken) == sorted(EXAMPLES)


@needs_buf
@pytest.mark.slow
def test_harmless_mutations_break_nothing(tmp_path: Path) -> None:
    """Buf has nothing to say of those that are called harmless."""
    found = buf.breaking_all([_folders(mutation, tmp_path / mutation.name) for mutation in HARMLESS])
    assert [mutation.name for mutation, findings in zip(HARMLESS, found) if findings] == []


@needs_buf
def test_buf_refuses_what_it_cannot_compare(tmp_path: Path) -> None:
    """A message set, which buf does not compile, is an error and not the absence of findings."""
    with pytest.raises(buf.BufError, match="MessageSet"):
        buf.breaking(*_folders(MESSAGE_SETS[0], tmp_path))


@needs_buf
def test_buf_says_the_same_in_any_category(tmp_path: Path) -> None:
    """A category is a choice among the findings of all; each finding is there once."""
    several = next(mutation for mutation in MUTATIONS if mutation.name == "several_in_three_files")
    before, after = _folders(several, tmp_path)
    findings = buf.breaking(before, after)
    assert findings == sorted(set(findings))
    for category in buf.CATEGORIES:
        chosen = [finding for finding in findings if category in buf.categories_of_rules()[finding.rule]]
        assert buf.breaking(before, after, [category]) == chosen


@needs_buf
def test_mutations_break_the_same_together(tmp_path: Path) -> None:
    """Many mutations as one are as many findings, at the same places, each in its mutation's folder."""
    alone = buf.breaking_all([_folders(mutation, tmp_path / mutation.name) for mutation in SEVERAL])
    places = {
        (f"{mutation.name}/{finding.path}", finding.line, finding.column, finding.rule)
        for mutation, findings in zip(SEVERAL, alone)
        for finding in findings
    }
    as_one = buf.breaking(*_folders(together(SEVERAL), tmp_path / "together"))
    assert {(finding.path, finding.line, finding.column, finding.rule) for finding in as_one} == places


def _folders(mutation: Mutation, folder: Path) -> tuple[Path, Path]:
    return write(mutation.before, folder / "before"), write(mutation.after, folder / "after")
