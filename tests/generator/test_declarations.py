"""The reader of .proto files that may not compile agrees with protoc on those that do, and never gives up on others."""

from __future__ import annotations

import re
from pathlib import Path
from random import Random
from typing import Any

import pytest
from declarations.descriptors import WELL_KNOWN, compiled, declared_names, ours, theirs
from declarations.layouts import UNUSUAL, laid_out
from golden import CASES, ROOT
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from roverlink.generator.protos.descriptors import schema_of
from roverlink.generator.protos.parser import File, parse, resolve_type
from roverlink.generator.protos.schema import ProtoField, ProtoMessage

_EXAMPLES = settings(max_examples=40, suppress_health_check=list(HealthCheck))
_FOLDERS = [ROOT / "proto", WELL_KNOWN]
_CASES = [case for case in CASES if any(path.startswith("proto/") for path in case.inputs)]
_CONTENTS = {path.read_bytes() for folder in _FOLDERS for path in folder.rglob("*.proto")}
_CONTENTS |= {content for case in _CASES for path, content in case.inputs.items() if path.endswith(".proto")}
_TEXTS = [content.decode() for content in sorted(_CONTENTS)]


# --- files that compile -----------------------------------------------------------------------------------------


def _agree(root: Path, name: str) -> bool:
    """Whether protoc takes a file; then, what was read of it is what protoc says."""
    files = compiled(root, name)
    if files:
        text = (root / name).read_bytes().decode("utf-8")
        assert ours(parse(text), declared_names(files)) == theirs(files[-1])
        assert parse(text).imported == tuple(files[-1].dependency)
    return bool(files)


@pytest.mark.slow
def test_files_are_read_as_protoc_reads_them(tmp_path: Path) -> None:
    """Names, numbers, types, labels, ranges, imports and places are protoc's in every file that compiles."""
    roots = [*_FOLDERS, *(case.write_inputs(tmp_path / case.name) / "proto" for case in _CASES)]
    files = [(root, path.relative_to(root).as_posix()) for root in roots for path in sorted(root.rglob("*.proto"))]
    assert {root.parent.name for root, name in files if not _agree(root, name)} <= {
        *("only_what_is_needed", "typo_file_of_an_import", "out108_foreign_files"),
        *("pro101_does_not_compile", "pro101_syntax", "pro102_unreadable_proto"),
    }


_ALONE = [text for text in _TEXTS if not re.search(r'^import (public |weak )?"(?!google/)', text, re.MULTILINE)]


@pytest.mark.slow
@settings(_EXAMPLES, max_examples=80)
@given(st.randoms(use_true_random=False))
def test_any_layout_is_read_as_protoc_reads_it(tmp_path_factory: pytest.TempPathFactory, random: Random) -> None:
    """So are files with comments and line ends wherever there may be any, and with numbers in any base."""
    root = tmp_path_factory.getbasetemp()
    random = Random(random.getrandbits(64))  # noqa: S311  # one draw a file: hypothesis takes long over many
    original = random.choice([*UNUSUAL, random.choice(_ALONE)])
    (root / "random.proto").write_bytes(original.encode())
    compiles = _agree(root, "random.proto")
    assert compiles or original not in UNUSUAL
    text = laid_out(random, original)
    (root / "random.proto").write_bytes(text.encode())
    assert _agree(root, "random.proto") or not compiles, text


_SCOPES = """\
syntax = "proto3"; package A.B;
message A {{ message B {{ message C {{ {0} x = 1; }} }} message D {{ enum A {{ Z = 0; }} }} }}
message B {{ message A {{ message D {{ }} }} }}
message E {{ {0} x = 1; }}
"""
_NAMES = [
    ".".join([a, b, c]).rstrip(".") for a in "ABCDE" for b in ["A", "B", "D", ""] for c in ["A", "C", ""] if b or not c
]


@pytest.mark.slow
def test_types_are_found_as_protoc_finds_them(tmp_path: Path) -> None:
    """A name means what protoc takes it to mean, or nothing where protoc finds nothing, in each of two scopes."""
    names = frozenset(item.full_name for item in _all(parse(_SCOPES.format("int32"))))
    for name in [*_NAMES, *(f".A.B.{name}" for name in _NAMES)]:
        for scope, place in (("A.B.A.B.C", 0), ("A.B.E", 1)):
            texts = [name if index == place else "int32" for index in range(2)]
            lines = _SCOPES.splitlines(keepends=True)
            text = "".join([*lines[:1], lines[1].format(texts[0]), lines[2].format(""), lines[3].format(texts[1])])
            (tmp_path / "a.proto").write_text(text, encoding="utf-8")
            files = compiled(tmp_path, "a.proto")
            found = schema_of(FileDescriptorSet(file=files), "").messages.get(scope)
            assert resolve_type(name, scope, names) == (found.fields[0].wire_type if found else None), (name, scope)


def _all(file: File) -> list[Any]:
    return [*file.messages, *file.enums]


# --- what protoc does not tell ----------------------------------------------------------------------------------


def _message(inside: str, **expected: Any) -> ProtoMessage:
    """The only message of a file, with this between its braces."""
    file = parse(f"message M {{\n{inside}\n}}\n")
    assert not file.broken, file.problems
    return file.messages[0]


def _numbers(message: ProtoMessage) -> dict[str, int]:
    return {field.name: field.number for field in message.fields}


def test_options_are_passed_over() -> None:
    """Whatever stands in the values of options, nothing of it is taken for a declaration."""
    text = """
      option (my.option) = { a: "}" b { c: [1, 2]; } };
      string s = 1 [(nanopb) . max_size = 20, json_name="a" "b", features.x = {y: 1}, default = -inf];
    """
    message = _message(text)
    assert _numbers(message) == {"s": 1}
    assert hash(message)


def test_a_message_set_goes_further() -> None:
    """What max is in a message set is not what it is elsewhere."""
    message = _message("option message_set_wire_format = true; extensions 4 to max [declaration = {number: 4}];")
    assert message.extension_ranges == ((4, 2**31 - 2),)
    assert _message("extensions 4 to max;").extension_ranges == ((4, 536870911),)


_CLAIMS = """\
syntax = "proto3";
// uint32 outside = 1;
message M {
  // uint32 timeout = 30;  // since 2.0
  /* SensorBoardX x = 12; */
  // Was once 5, see x = 5; and the version = 7; before.
  //   repeated .a.Foo bar = 0x3 [packed=true];
  oneof choice {
    bool yes = 1;  // int32 no = 2;
    /**
     * map<string,  Foo> all = 8;
     */
  }
  // message Inner { int32 not_ours = 1;
  //   int32 nor_this = 2;
  // }
  // oneof old {
  //   int32 a = 40; int32 b = 41;
  // }
  // option foo = 3;
  // reserved_later = 4;
  enum E {
    ZERO = 0;
    // RESERVED_LATER = 4;
    /* NEGATIVE = -1 [deprecated = true]; */
    // int32 x = 9;
  }
  /*\tint32 ä = 1;\tint32 last = 99; */
  //	int32 tab = 98;
}
// uint32 outside = 2;
"""


def test_claims_are_what_was_commented_out() -> None:
    """Fields and enum values in comments are claims on their numbers where they would be declared, and nowhere else."""
    file = parse(_CLAIMS)
    message = file.messages[0]
    assert [(claim.number, claim.name, claim.type, claim.oneof) for claim in message.claims] == [
        (30, "timeout", "uint32", ""),
        (12, "x", "SensorBoardX", ""),
        (3, "bar", ".a.Foo", ""),
        (2, "no", "int32", "choice"),
        (8, "all", "map<string, Foo>", "choice"),
        (40, "a", "int32", "old"),
        (41, "b", "int32", "old"),
        (98, "tab", "int32", ""),
    ]
    assert [(claim.number, claim.name) for claim in file.enums[0].claims] == [(4, "RESERVED_LATER"), (-1, "NEGATIVE")]
    places = {claim.name: (claim.span.line, claim.span.column) for claim in message.claims}
    assert places["timeout"] == (4, 6)
    assert places["no"] == (9, 23)
    assert places["tab"] == (29, 9)


# --- files that do not compile ----------------------------------------------------------------------------------

_BROKEN = {
    "no semicolon": ("int32 a = 1\nint32 b = 2;", {"a": 1, "b": 2}),
    "no semicolon after options": ("int32 a = 1 [deprecated = true]\nint32 b = 2;", {"a": 1, "b": 2}),
    "no closing bracket": ("int32 a = 1 [deprecated = true;\nint32 b = 2;", {"a": 1, "b": 2}),
    "no closing bracket nor semicolon": ("int32 a = 1 [deprecated = true\nint32 b = 2;", {"a": 1, "b": 2}),
    "no closing quote": ('int32 a = 1 [json_name = "x];\nint32 b = 2;', {"a": 1, "b": 2}),
    "no end of comment": ("int32 a = 1; /* one\nint32 b = 2;", {"a": 1, "b": 2}),
    "no number": ("int32 a = ;\nint32 b = 2;", {"b": 2}),
    "no number nor semicolon": ("int32 a =\nint32 b = 2;", {"b": 2}),
    "no equals sign": ("int32 a 1;\nint32 b = 2;", {"a": 1, "b": 2}),
    "no type": ("a = 1;\nint32 b = 2;", {"a": 1, "b": 2}),
    "no octal number": ("int32 a = 09;\nint32 b = 2;", {"b": 2}),
    "a negative number": ("int32 a = -1;\nint32 b = 2;", {"b": 2}),
    "a number too long for Python": (f"int32 a = {'9' * 9999};\nint32 b = 2;", {"b": 2}),
    "two numbers": ("int32 a = 1 3;\nint32 b = 2;", {"a": 1, "b": 2}),
    "a letter of another alphabet": ("int32 ä = 1;\nint32 b = 2;", {"ä": 1, "b": 2}),
    "a space that is none": ("int32\u00a0a = 1;\nint32 b\x00 = 2;", {"a": 1, "b": 2}),
    "prose": ("this is; not a field ...\nint32 b = 2;", {"b": 2}),
    "a stray sign": ("int32 a = 1;\n?\nint32 b = 2;\n@ int32 c = 3;", {"a": 1, "b": 2}),
    "a field before a message": ("int32 a = 1 message In {}\nint32 b = 2;", {"a": 1, "b": 2}),
    "an unknown block": ("int32 a = 1;\nmesage X { int32 x = 3; }\n{ int32 x = 4; }\nint32 b = 2;", {"a": 1, "b": 2}),
    "a keyword as a type": ("message a = 1;\nreserved b = 2;", {"a": 1, "b": 2}),
    "a group without a body": ("optional group A = 1;\nint32 b = 2;", {"a": 1, "b": 2}),
    "both sides of a conflict": (
        "<<<<<<< HEAD\nint32 a = 1;\n||||||| base\nint32 c = 3;\n=======\nint32 b = 2;\n>>>>>>> theirs",
        {"a": 1, "b": 2},
    ),
    "a block that is not closed": ("int32 a = 1;\n  message In {\n    int32 x = 1;\n", {"a": 1}),
    "a block that is not opened": (
        "int32 a = 1;\n  oneof o\n    int32 b = 2;\n  }\n  int32 c = 3;",
        {"a": 1, "b": 2, "c": 3},
    ),
    "too much before a brace": ("int32 a = 1;\n  enum I[n x {\n    A = 0;\n  }\n  int32 b = 2;", {"a": 1, "b": 2}),
    "a brace within a line": ("  int32 a = 1;\n  int{32 b = 2;\n  int32 c = 3;", {"a": 1, "c": 3}),
    "a closing brace within a line": ("  int32 a = 1;\n  int}32 b = 2;\n  int32 c = 3;", {"a": 1, "c": 3}),
    "a brace too many": ("int32 a = 1;\n  }\n  int32 b = 2;", {"a": 1, "b": 2}),
    "an option that does not end": ("int32 a = 1;\n  option (x) = { y: 1;\n  repeated A.B b = 2;", {"a": 1, "b": 2}),
}


@pytest.mark.parametrize("name", _BROKEN)
def test_a_broken_line_hides_no_other(name: str) -> None:
    """What a broken line still says is read; so are its neighbours and the messages around; and it is a problem."""
    inside, numbers = _BROKEN[name]
    file = parse(f"message A {{ int32 x = 1; }}\n\nmessage M {{\n{inside}\n}}\nmessage Z {{\n  A z = 9;\n}}\n")
    assert [message.name for message in file.outermost] == ["A", "M", "Z"]
    assert _numbers(file.outermost[1]) == numbers
    assert _numbers(file.outermost[2]) == {"z": 9}
    assert file.broken
    assert all(file.problems[0].line <= problem.line for problem in file.problems)
    assert file.problems[0].line >= 3


def test_a_broken_enum_value_hides_no_other() -> None:
    """What holds for fields holds for the values of an enum and for what it reserves."""
    file = parse(
        "enum E {\n  A = 0\n  B = x;\n  C = -0x2 [deprecated = true;\n  reserved -5 to -3, D, 9 to max\n  F = 4;\n}\n"
    )
    assert [(value.name, value.number) for value in file.enums[0].values] == [("A", 0), ("C", -2), ("F", 4)]
    assert file.enums[0].reserved == ((-5, -3), (9, 2**31 - 1))
    assert file.enums[0].reserved_names == ("D",)
    assert [problem.line for problem in file.problems] == [2, 3, 4, 5]


def test_the_top_of_a_file_is_read_as_far_as_it_goes() -> None:
    """A broken statement hides neither package nor imports."""
    imports = 'import "x.proto\nimport public "y.proto";\n'
    file = parse(f'syntax = "proto3"\npackage a.b\n{imports}foo\nmessage M {{}}\n}}\nenum E {{ A = 0; }}')
    assert (file.syntax, file.package) == ("proto3", "a.b")
    assert [(item.path, item.kind, item.line) for item in file.imports] == [
        ("x.proto", "", 3),
        ("y.proto", "public", 4),
    ]
    assert [item.full_name for item in _all(file)] == ["a.b.M", "a.b.E"]


def test_braces_that_match_are_believed() -> None:
    """Without indentation, a message in another one is in it, as long as no brace is missing."""
    text = "message A {\nmessage B {\nint32 x = 1;\n}\n}\n"
    assert [message.full_name for message in parse(text).messages] == ["A", "A.B"]
    assert [message.full_name for message in parse(text.removesuffix("}\n")).messages] == ["A", "B"]


# --- any text at all --------------------------------------------------------------------------------------------

_WORDS = [
    *("message", "enum", "oneof", "extend", "group", "reserved", "extensions", "option", "optional", "map", "service"),
    *("A", "B.c", "ä", "x", "1", "-", "0x1F", "to", "max", "'a'", "<", ">", ",", "[", "]", "(", ")", "{", "}", ";"),
    *("=", '"', "'", "\\", "//", "/*", "*/", "\n", "\n}\n", "\r", "\t", "\x00", "\ud800", "\ufeff", "\n=======\n"),
    "\n|||||||\n",
]


def _holds_together(text: str) -> None:
    """Whatever is read is in the text, where it is said to be, and can be kept in sets."""
    file = parse(text)
    assert hash(file) == hash(parse(text))
    lines = text.count("\n") + 1
    for message in file.messages:
        assert 1 <= message.span.line <= lines
        assert all(isinstance(item, ProtoField) and item.name in text.lower() + text for item in message.fields)
        assert all(claim.name in text for claim in message.claims)
    assert all(1 <= problem.line <= lines for problem in file.problems)


@_EXAMPLES
@given(st.lists(st.sampled_from(_WORDS), max_size=60).map(" ".join) | st.text(max_size=80))
def test_any_text_is_read(text: str) -> None:
    """Words of the grammar in any order, or any characters, give a file."""
    _holds_together(text)


@_EXAMPLES
@given(st.randoms(use_true_random=False), st.binary(max_size=3))
def test_any_damaged_file_is_read(random: Random, piece: bytes) -> None:
    """So does a file of which pieces were cut out, moved or overwritten."""
    text = random.choice(_TEXTS)[:6000]
    for _ in range(random.randint(1, 6)):
        start, end, to = sorted(random.randrange(len(text) + 1) for _ in range(3))
        moved = random.choice(["", text[start : start + 80], piece.decode("latin-1"), random.choice(_WORDS)])
        text = text[:start] + text[min(start + random.randrange(80), end) : to] + moved + text[to:]
    _holds_together(text)


_ENDLESS = [
    *('"', '\\"', '"\\', "'\\'", '"\n', "/*", "/*\n", "*/", "/", "/**/", "// x\n", "{", "}", "{\n", "\n}", "{}", "["),
    *("]", "(", "<", "a", "a.", "a ", "a=1[", "= ", "9", "9 ", "ä", "\t", "\n", "\x00", "-", ",", "to ", "message a{"),
    *("oneof a{", "message a\n", "message a{\n", "  message A {\n }\n", "option (a) = {", "option a\n"),
    *("int32 x = 1 [", "map<", "group A=1{", "reserved 1,", "reserved ", "// a b = 1;", "// message a {", "// }"),
    *("/* a b = 1; ", "// a b = 1 [\n", "export ", "enum A{B", "<<<<<<< \n", "||||||| \n", "=======\n"),
    *("|||||||\n=======\n", "optional ", "extend A{", "service A{rpc B(C)", "import "),
]


@pytest.mark.slow
def test_the_reader_comes_to_an_end() -> None:
    """A long file of one piece, nested deeper than Python's stack, is read to its end."""
    for part in _ENDLESS:
        file = parse("message A {" + part * 1200)
        assert file.broken, part
        assert file.messages[0].name == "A"
