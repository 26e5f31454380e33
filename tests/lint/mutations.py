"""Pairs of states of a schema: the files under `states/`, and the same after an edit that somebody might make.

`MUTATIONS` are small edits of each kind, and the `MATRICES`, in which every type, cardinality, default, oneof, enum and
reserved range becomes every other. What a checker of breaking changes is to say of them does not stand here: ask `buf`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path

STATES = Path(__file__).parent / "states"

TELEMETRY = "rover/telemetry.proto"  # proto3
PARTS = "rover/parts.proto"  # proto3, imported by the others
LEGACY = "rover/legacy.proto"  # proto2
MODERN = "rover/modern.proto"  # edition 2023

BASE = {
    path.relative_to(STATES).as_posix(): path.read_text(encoding="utf-8") for path in sorted(STATES.rglob("*.proto"))
}

Change = tuple[str, str, str]  # path, what stands there, what is to stand there


@dataclass(frozen=True)
class Mutation:
    """A schema before and after; the files of a state are texts by path."""

    name: str
    before: dict[str, str]
    after: dict[str, str]


def write(state: dict[str, str], folder: Path) -> Path:
    """The state as files, and the folder they are in."""
    for path, text in state.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(text.encode())
    return folder


def edit(name: str, path: str, old: str, new: str) -> Mutation:
    """One edit of one file."""
    return edits(name, (path, old, new))


def edits(name: str, *changes: Change, before: dict[str, str] = BASE) -> Mutation:
    """Several edits, each of text that stands in its file once."""
    after = dict(before)
    for path, old, new in changes:
        assert after[path].count(old) == 1, f"{name}: {old!r} is {after[path].count(old)} times in {path}"
        assert old != new, f"{name}: nothing changes"
        after[path] = after[path].replace(old, new)
    return Mutation(name, before, after)


def both_ways(name: str, path: str, old: str, new: str) -> list[Mutation]:
    """An edit, and the way back."""
    forth = edit(name, path, old, new)
    return [forth, Mutation(f"{name}_undone", forth.after, forth.before)]


def together(mutations: Sequence[Mutation]) -> Mutation:
    """Many as one, each in a folder of its name and in packages of its own, for who would rather compare once.

    Lines and columns stay as they are, but for those of packages and imports. What a mutation says by using no package
    or by importing a file no more, it can say only alone.
    """
    assert len({mutation.name for mutation in mutations}) == len(mutations)
    sides: tuple[dict[str, str], dict[str, str]] = ({}, {})
    for number, mutation in enumerate(mutations):
        paths = mutation.before.keys() | mutation.after.keys()
        for side, state in zip(sides, (mutation.before, mutation.after)):
            for path, text in state.items():
                moved = re.sub(r"^package (\w+);", rf"package \g<1>{number};", text, flags=re.MULTILINE)
                moved = moved.replace(" .rover.", f" .rover{number}.")
                for imported in paths:
                    moved = moved.replace(f'import "{imported}"', f'import "{mutation.name}/{imported}"')
                side[f"{mutation.name}/{path}"] = moved
    return Mutation("together", *sides)


def _cut(text: str, start: str, end: str) -> str:
    """The part of a text from one phrase up to and with another."""
    begin = text.index(start)
    return text[begin : text.index(end, begin) + len(end)]


_GEAR = _cut(BASE[PARTS], "enum Gear", "}\n")
_BOX = _cut(BASE[LEGACY], "  optional group Box", "}\n")
_WHEEL = _cut(BASE[TELEMETRY], "  // One of six.", "\n  }\n")
_SPARE = _cut(BASE[PARTS], "// What nobody", "}\n")
_TOP = "// What the rover says of itself.\n"
_GEARS = _GEAR.replace("REVERSE = -1;", "REVERSE = -1;\n  HIGH = 2;")

# --- fields ---

FIELDS = [
    edit("int32_to_string", TELEMETRY, "int32 speed", "string speed"),
    edit("message_to_other_message_of_same_fields", TELEMETRY, "Vector position", "Point position"),
    edit("message_to_nested_message", TELEMETRY, "Vector position", "Wheel position"),
    edits(
        "well_known_type_not_used_any_more",
        (TELEMETRY, 'import "google/protobuf/timestamp.proto";\n', ""),
        (TELEMETRY, "google.protobuf.Timestamp stamp", "int64 stamp"),
    ),
    edit("group_to_message", LEGACY, _BOX, "  optional Crate box = 4;\n"),
    edit("field_of_group", LEGACY, "    optional int32 width", "    optional string width"),
    edits(
        "enum_replaced_by_larger_namesake",
        (TELEMETRY, "Gear gear", "Gears.Gear gear"),
        (TELEMETRY, _TOP, f"message Gears {{\n{_GEARS}}}\n\n{_TOP}"),
    ),
    edits(
        "map_to_repeated_entries",
        (TELEMETRY, "map<string, int32> counters", "repeated CountersEntry counters"),
        (TELEMETRY, "  // One of six.", "  message CountersEntry {\n    string key = 1;\n    int32 value = 2;\n  }\n"),
    ),
    edit("field_deleted", TELEMETRY, "  string label = 2;\n", ""),
    edit("field_renamed_same_json_name", TELEMETRY, "string label", 'string title_text = 2 [json_name = "label"]; //'),
    edits("names_swapped", (TELEMETRY, "string label", "string payload"), (TELEMETRY, "bytes payload", "bytes label")),
    edit("json_name_spelled_out", TELEMETRY, "stamp_fixed = 25", 'stamp_fixed = 25 [json_name = "stampFixed"]'),
    edit("default_gone_with_label", LEGACY, "optional int32 level = 2 [default = 5]", "repeated int32 level = 2"),
    edits(
        "moved_between_oneofs",
        (TELEMETRY, "    int32 stop = 11;\n", ""),
        (TELEMETRY, "string text = 13;", "string text = 13;\n    int32 stop = 11;"),
    ),
]

# --- enums and messages ---

TYPES = [
    edit("value_deleted", PARTS, "  MODE_DRIVING = 1;\n", ""),
    edits("values_swapped", (PARTS, "MODE_DRIVING = 1", "MODE_DRIVING = 2"), (PARTS, "MODE_ARM = 2", "MODE_ARM = 1")),
    edit(
        "closed_enum_first_value_changed",
        LEGACY,
        "  COLOR_RED = 1;\n  COLOR_GREEN = 2;",
        "  COLOR_GREEN = 2;\n  COLOR_RED = 1;",
    ),
    edits("enum_deleted", (TELEMETRY, "  Gear gear = 22;\n", ""), (PARTS, _GEAR, "")),
    edits("enum_renamed", (TELEMETRY, "Mode mode", "Phase mode"), (PARTS, "enum Mode", "enum Phase")),
    edits("enum_moved_to_other_file", (PARTS, _GEAR, ""), (TELEMETRY, _TOP, f"{_GEAR}\n{_TOP}")),
    edit("message_deleted", PARTS, _SPARE, ""),
    edits("message_moved", (PARTS, _SPARE, ""), (TELEMETRY, _TOP, f"{_SPARE}\n{_TOP}")),
    edits("nested_message_deleted", (TELEMETRY, "  Wheel wheel = 20;\n", ""), (TELEMETRY, _WHEEL, "")),
    edit("message_emptied", PARTS, "  int32 count = 1;\n", ""),
    *both_ways(
        "accessor_removed", PARTS, "  int32 count", "  option no_standard_descriptor_accessor = true;\n  int32 count"
    ),
    edit("extension_deleted", LEGACY, "  optional int32 bonus = 100;\n", ""),
    edit("extension_renamed", LEGACY, "int32 bonus", "int32 extra"),
    edit("extension_renumbered", LEGACY, "bonus = 100", "bonus = 110"),
    edit("extension_of_other_type", LEGACY, "optional int32 bonus", "optional string bonus"),
    edit("extension_default_changed", LEGACY, 'remark = 101 [default = "none"]', 'remark = 101 [default = "some"]'),
]

_EXTENSIONS = "  extensions 4 to 1000;"
MESSAGE_SETS = both_ways("message_set", LEGACY, _EXTENSIONS, f"  option message_set_wire_format = true;\n{_EXTENSIONS}")
"""Buf refuses to compile these."""

# --- files ---


def _without(name: str, path: str) -> Mutation:
    """A file deleted."""
    return Mutation(name, BASE, {file: text for file, text in BASE.items() if file != path})


def _moved(name: str, path: str, new_path: str) -> Mutation:
    """A file under another name, in the imports as well."""
    state = {file: text.replace(f'"{path}"', f'"{new_path}"') for file, text in BASE.items() if file != path}
    return Mutation(name, BASE, {**state, new_path: BASE[path]})


def _prefixed(name: str, prefix: str) -> Mutation:
    """An edit that breaks, behind something on its line that makes columns hard to count; the same before it."""
    before = BASE | {TELEMETRY: BASE[TELEMETRY].replace("  string label", prefix + "string label")}
    return edits(name, (TELEMETRY, "string label", "int32 label"), before=before)


_CRLF = {path: text.replace("\n", "\r\n") for path, text in BASE.items()}
_NO_PACKAGE = {path: text.replace("package rover;\n\n", "") for path, text in BASE.items()}
_PROTO2 = BASE[PARTS].replace("proto3", "proto2").replace("  double", "  optional double")
_PROTO2_AFTER = {PARTS: _PROTO2.replace("  int32", "  optional int32")}
_ONE_LINE = BASE | {
    PARTS: "message Spare { string count = 1; enum E { A = 0; B = 1; } }\n".join(BASE[PARTS].split(_SPARE))
}
_OPTION = "package rover;\n\noption "

FILES = [
    _without("file_deleted", MODERN),
    _moved("file_renamed", MODERN, "rover/new.proto"),
    _moved("imported_file_renamed", PARTS, "rover/pieces.proto"),
    Mutation("file_added", _without("", MODERN).after, BASE),
    Mutation("package_changed", BASE, {path: text.replace("age rover;", "age mars;") for path, text in BASE.items()}),
    edits("no_package", (TELEMETRY, "int32 speed", "string speed"), (PARTS, _SPARE, ""), before=_NO_PACKAGE),
    Mutation("syntax_changed_to_proto2", {PARTS: BASE[PARTS]}, _PROTO2_AFTER),
    Mutation("syntax_changed_to_proto3", _PROTO2_AFTER, {PARTS: BASE[PARTS]}),
    edits("crlf", (TELEMETRY, "int32 speed", "string speed"), (PARTS, "MODE_ARM", "MODE_HAND"), before=_CRLF),
    _prefixed("behind_tab_in_comment", "  /*\t*/ "),
    _prefixed("behind_emoji", "  /* 🤖 */ "),
    _prefixed("behind_combined_letters", "  /* a\u0308 👩\u200d🚀 */ "),
    edits("all_on_one_line", (PARTS, "string count = 1", "int64 count = 1"), (PARTS, " B = 1;", ""), before=_ONE_LINE),
]

# --- features of editions ---

_JAVA = edits("", (MODERN, "package rover;", 'package rover;\n\nimport "google/protobuf/java_features.proto";')).after
_CPP = edits("", (MODERN, "package rover;", 'package rover;\n\nimport "google/protobuf/cpp_features.proto";')).after
_UNVERIFIED = "title = 2 [features.utf8_validation = NONE]"
_NO_JSON = "  option features.json_format = LEGACY_BEST_EFFORT;\n"


def _file_feature(name: str, feature: str) -> Mutation:
    """A feature set for the whole file."""
    return edit(name, MODERN, "package rover;\n", f"{_OPTION}features.{feature};\n")


FEATURES = [
    _file_feature("presence_implicit_in_file", "field_presence = IMPLICIT"),
    _file_feature("utf8_unverified_in_file", "utf8_validation = NONE"),
    _file_feature("enums_closed_in_file", "enum_type = CLOSED"),
    _file_feature("delimited_in_file", "message_encoding = DELIMITED"),
    _file_feature("json_best_effort_in_file", "json_format = LEGACY_BEST_EFFORT"),
    *both_ways("utf8_unverified", MODERN, "title = 2", _UNVERIFIED),
    *both_ways("enum_closed", MODERN, "  SHADE_NONE", "  option features.enum_type = CLOSED;\n  SHADE_NONE"),
    edit("expanded", MODERN, "samples = 3", "samples = 3 [features.repeated_field_encoding = EXPANDED]"),
    *both_ways("json_of_message_best_effort", MODERN, "  int32 level", f"{_NO_JSON}  int32 level"),
    edits(
        "java_verifies_utf8",
        (MODERN, "= NONE]", "= NONE, features.(pb.java).utf8_validation = VERIFY]"),
        before=_JAVA | {MODERN: _JAVA[MODERN].replace("title = 2", _UNVERIFIED)},
    ),
    edits("cpp_string_view", (MODERN, "title = 2", "title = 2 [features.(pb.cpp).string_type = VIEW]"), before=_CPP),
]

# --- what breaks nothing ---

HARMLESS = [
    Mutation("nothing", BASE, BASE),
    edit("comment_added", TELEMETRY, "  string label", "  // What to show.\n  string label"),
    edit("comment_changed", TELEMETRY, "Forward, in mm/s.", "Forward, in mm a second."),
    edit("file_comment_removed", TELEMETRY, "// What the rover sends.\n", ""),
    edit("formatting", TELEMETRY, "  string label = 2;", "\n\n\tstring   label\n=2 ;"),
    edits(
        "fields_reordered",
        (TELEMETRY, "  string label = 2;\n", ""),
        (TELEMETRY, "bytes payload = 3;", "bytes payload = 3;\n  string label = 2;"),
    ),
    edits("messages_reordered", (PARTS, _SPARE, ""), (PARTS, "// A place or", f"{_SPARE}\n// A place or")),
    edit("field_added", TELEMETRY, "  string label", "  int32 more = 43;\n  string label"),
    edit("message_added", PARTS, "message Spare", "message Fresh {}\n\nmessage Spare"),
    edit("oneof_added", TELEMETRY, "  string label", "  oneof fresh {\n    int32 more = 43;\n  }\n  string label"),
]

# --- every kind to every other ---

_SCALARS = "double float int32 int64 uint32 uint64 sint32 sint64 fixed32 fixed64 sfixed32 sfixed64 bool string bytes"
_KEYS = [scalar for scalar in _SCALARS.split() if scalar not in ("double", "float", "bytes")]
_KINDS = [*_SCALARS.split(), "Thing", "Other", "Kind", "Sort"]
_DECLARED = """\
message Thing {}
message Other {}
enum Kind { KIND_A = 0; }
enum Sort { SORT_A = 0; }
"""
_DEFAULTS = [
    *(f"int64 f# = #{default}" for default in ("", " [default = 0]", " [default = 1]", " [default = -1]")),
    *(f"double f# = #{default}" for default in ("", " [default = 1]", " [default = 0.1]", " [default = -0.0]")),
    *(f"float f# = #{default}" for default in (" [default = 0.1]", " [default = inf]", " [default = nan]")),
    *("double f# = # [default = nan]", "double f# = # [default = -inf]", "double f# = # [default = 1e300]"),
    *("uint64 f# = # [default = 18446744073709551615]", "int64 f# = # [default = 9223372036854775807]"),
    *(f"bool f# = #{default}" for default in ("", " [default = false]", " [default = true]")),
    *(f"string f# = #{default}" for default in ("", ' [default = ""]', ' [default = "1"]', ' [default = "ä\\n"]')),
    *(f"bytes f# = #{default}" for default in ("", ' [default = "1"]', ' [default = "\\303\\244\\n"]')),
    *(f"Tone f# = #{default}" for default in ("", " [default = TONE_LOW]", " [default = TONE_HIGH]")),
    *("Tint f# = #", "Tint f# = # [default = TINT_ONE]", "Hold f# = #"),
]
_DEFAULTED = """\
enum Tone { TONE_LOW = 1; TONE_HIGH = 2; }
enum Tint { TINT_NONE = 0; TINT_ONE = 1; }
message Hold {}
"""
_PROTO3_HEAD = f'syntax = "proto3";\npackage grid;\n{_DECLARED}'
_PROTO2_HEAD = f'syntax = "proto2";\npackage grid;\n{_DECLARED}{_DEFAULTED}'
_EDITION_HEAD = f'edition = "2023";\npackage grid;\n{_DECLARED}'


def _matrix(
    name: str, head: str, shapes: Sequence[str], line: str = "  @;", around: str = "message Matrix {\n@}\n"
) -> Mutation:
    """A file with a line for each pair of shapes, which has the first shape before and the second after.

    In a line, @ stands for the shape; # stands for the number of the pair.
    """
    pairs = list(enumerate(permutations(shapes, 2), 1))
    sides = (
        "".join(line.replace("@", pair[side]).replace("#", str(number)) + "\n" for number, pair in pairs)
        for side in (0, 1)
    )
    before, after = ({"matrix.proto": f"{head}\n{around.replace('@', side)}"} for side in sides)
    return Mutation(name, before, after)


def _types(name: str, head: str, keyword: str, shapes: Sequence[str]) -> Mutation:
    """The same, with a message or an enum for each pair."""
    return _matrix(name, head, shapes, f"{keyword} T# {{ @ }}", "@")


MATRICES = [
    _matrix("every_type", _PROTO3_HEAD, [f"{kind} f# = #" for kind in _KINDS]),
    _matrix("every_type_repeated", _PROTO3_HEAD, [f"repeated {kind} f# = #" for kind in _KINDS]),
    _matrix("every_map_key", _PROTO3_HEAD, [f"map<{key}, Thing> f# = #" for key in _KEYS]),
    _matrix("every_map_value", _PROTO3_HEAD, [f"map<string, {kind}> f# = #" for kind in _KINDS]),
    _matrix(
        "every_cardinality_of_proto3",
        _PROTO3_HEAD,
        [
            *(f"{kind} f# = #" for kind in ("int32", "optional int32", "repeated int32", "map<int32, int32>")),
            *(f"{kind} f# = #" for kind in ("Thing", "optional Thing", "repeated Thing", "map<int32, Thing>")),
            *("oneof o# { int32 f# = #; }", "oneof o# { Thing f# = #; }", "string f# = #", "repeated string f# = #"),
        ],
    ),
    _matrix(
        "every_cardinality_of_proto2",
        _PROTO2_HEAD,
        [
            *(f"{label} int32 f# = #" for label in ("optional", "required", "repeated")),
            *(f"{label} group F# = # {{}}" for label in ("optional", "required", "repeated")),
            *("map<int32, int32> f# = #", "oneof o# { int32 f# = #; }", "oneof o# { group F# = # {} }"),
        ],
    ),
    _matrix(
        "every_cardinality_of_an_edition",
        _EDITION_HEAD,
        [
            *(f"string f# = # [features.field_presence = {presence}]" for presence in ("EXPLICIT", "IMPLICIT")),
            *("string f# = # [features.field_presence = LEGACY_REQUIRED]", "oneof o# { string f# = #; }"),
            *("repeated string f# = #", "repeated string f# = # [features.utf8_validation = NONE]"),
            *("Thing f# = #", "Thing f# = # [features.message_encoding = DELIMITED]"),
            *("repeated Thing f# = #", "repeated Thing f# = # [features.message_encoding = DELIMITED]"),
            *("map<string, string> f# = #", "map<string, string> f# = # [features.utf8_validation = NONE]"),
        ],
    ),
    _matrix("every_default", _PROTO2_HEAD, [f"optional {shape}" for shape in _DEFAULTS]),
    _matrix(
        "every_option",
        _PROTO3_HEAD,
        [
            *("string f# = #", 'string f# = # [json_name = "one#"]', 'string f# = # [json_name = "other#"]'),
            *(f"string f# = # [ctype = {ctype}]" for ctype in ("CORD", "STRING", "STRING_PIECE")),
            *(f"int64 f# = # [jstype = {type}]" for type in ("JS_STRING", "JS_NUMBER", "JS_NORMAL")),
            *("string f# = # [deprecated = true]", "int64 f# = #"),
        ],
    ),
    _types(
        "every_deletion",
        _PROTO3_HEAD,
        "message",
        [
            *("int32 a = 1; string b = 2;", "int32 a = 1; string b = 3;", "int32 a = 2; string b = 1;", "int32 a = 1;"),
            *("int32 a = 1; reserved 2;", 'int32 a = 1; reserved "b";', 'int32 a = 1; reserved 2; reserved "b";'),
            *("reserved 1 to 2;", "int32 a = 1; string speed = 2;", "int32 a = 1; repeated string pace = 2;"),
            'int32 a = 1; reserved 2; reserved "b"; string speed = 4;',
        ],
    ),
    _types(
        "every_oneof",
        _PROTO3_HEAD,
        "message",
        [
            *("int32 a = 1; int32 b = 2;", "oneof o { int32 a = 1; int32 b = 2; }", "int32 a = 1;"),
            *("oneof p { int32 a = 1; int32 b = 2; }", "oneof o { int32 a = 1; } int32 b = 2;"),
            *("oneof o { int32 a = 1; } oneof p { int32 b = 2; }", "optional int32 a = 1; int32 b = 2;"),
            *("oneof o { int32 a = 1; int32 b = 2; int32 c = 3; }", 'reserved 1, 2; reserved "a", "b";'),
            "oneof o { int32 a = 1; } repeated int32 b = 2;",
        ],
    ),
    _types(
        "every_reserved_range",
        _PROTO3_HEAD,
        "message",
        [
            *(
                "",
                "reserved 50;",
                "int32 fresh = 50;",
                "reserved 60 to 69;",
                "reserved 60 to 68;",
                "reserved 62 to 69;",
            ),
            *("reserved 60, 62 to 64, 67 to 69;", "reserved 60 to 64, 65 to 69;", "reserved 65 to 74, 50;"),
            *("reserved 1000 to max;", "reserved 1000 to 2000;"),
            *('reserved "a", "b";', 'reserved "b";', 'reserved "b", "a";'),
        ],
    ),
    _types(
        "every_extension_range",
        _PROTO2_HEAD,
        "message",
        [
            *("extensions 100 to 199, 500 to max;", "extensions 100 to 199;", "extensions 100 to 150, 500 to max;"),
            *("extensions 100 to 150, 151 to 199;", "extensions 500 to 600;", ""),
        ],
    ),
    _types(
        "every_enum",
        _PROTO3_HEAD,
        "enum",
        [
            *("A# = 0; B# = 1;", "A# = 0;", "A# = 0; reserved 1;", 'A# = 0; reserved "B#";', "N# = 0; B# = 1;"),
            *(
                'A# = 0; reserved 1; reserved "B#";',
                "A# = 0; RED# = 1;",
                "A# = 0; B# = 2;",
                "A# = 0; B# = 1; RED# = 2;",
            ),
            *("A# = 0; RED# = 1; B# = 2;", "A# = 0; B# = 1; M# = -1;", "A# = 0; B# = 1; N# = -1;"),
            *(f"option allow_alias = true; A# = 0; {more}" for more in ("B# = 1; RED# = 1;", "RED# = 1; B# = 1;")),
            *(f"option allow_alias = true; {more}" for more in ("A# = 0; N# = 0; B# = 1;", "A# = 0; P# = 1; Q# = 1;")),
        ],
    ),
    _types(
        "every_reserved_range_of_enums",
        _PROTO3_HEAD,
        "enum",
        [
            f"A# = 0; {reserved}"
            for reserved in (
                *("", "reserved 5;", "reserved 10 to 15;", "reserved 10 to 14;", "reserved 11 to 16, 5;", "FIVE# = 5;"),
                *("reserved 10 to 12, 13 to 15;", "reserved -10 to -5;", "reserved -9 to -6;", "reserved 100 to max;"),
                *("reserved 100 to 200;", 'reserved "OLD#", "OLDER#";', 'reserved "OLDER#";'),
            )
        ],
    ),
]

MUTATIONS = [*FIELDS, *TYPES, *FILES, *FEATURES, *HARMLESS, *MATRICES]
