"""The largest sizes of messages are those that nanopb's own generator writes into its headers."""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from unittest import mock

import grpc_tools
import pytest
from golden import ROOT, inside
from google.protobuf.compiler.plugin_pb2 import CodeGeneratorRequest, CodeGeneratorResponse
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from grpc_tools import protoc

from roverlink.generator.diagnostics import Diagnostic
from roverlink.generator.nanopb import Bounds, Unbounded, field_sizes, largest_size, read_bounds
from roverlink.generator.nanopb.vocabulary import vocabulary
from roverlink.generator.protos.descriptors import schema_of
from roverlink.generator.protos.schema import Schema

# It would choose protobuf's pure Python implementation for all processes that this one starts.
with pytest.MonkeyPatch.context() as environment:
    environment.setenv("PROTOCOL_BUFFERS_PYTHON_IMPLEMENTATION", "upb")
    nanopb = pytest.importorskip("nanopb.generator.nanopb_generator", reason="need nanopb (pip install nanopb)")

_DATA = ROOT / "tests" / "generator" / "nanopb"
_NANOPB_PROTO = Path(nanopb.__file__).parent / "proto"
_WELL_KNOWN = Path(grpc_tools.__file__).parent / "_proto"


# --- nanopb ---------------------------------------------------------------------------------------------------------


def _compiled(root: Path, files: list[str], *flags: str) -> FileDescriptorSet:
    result = root / "descriptors"
    folders = [f"-I{folder}" for folder in (root, _NANOPB_PROTO, _WELL_KNOWN)]
    command = ["protoc", *folders, f"--descriptor_set_out={result}", "--include_imports", *flags, *files]
    assert protoc.main(command) == 0
    return FileDescriptorSet.FromString(result.read_bytes())


class _Stream:
    """A standard stream of a program that asks for its number."""

    def __init__(self, path: Path, flags: int) -> None:
        self._number = os.open(path, flags | os.O_CREAT, 0o600)

    def fileno(self) -> int:
        return self._number  # whoever asks opens it, and closes it


@dataclass
class _Headers:
    """What nanopb wrote."""

    text: str
    complaints: str

    def size(self, message: str) -> int | None:
        """The size of a message, by the name that it has in C; none if nanopb knows none."""
        return self._value(f"{message}_size", ())

    def mentions(self, message: str) -> bool:
        """Whether nanopb knows the message at all."""
        return re.search(rf"\b{message}_size\b", self.text) is not None

    def _value(self, macro: str, within: tuple[str, ...]) -> int | None:
        defined = re.search(rf"^#define {macro} +(.*)$", self.text, re.MULTILINE)
        return self._evaluated(defined[1], (*within, macro)) if defined and macro not in within else None

    def _evaluated(self, expression: str, within: tuple[str, ...]) -> int | None:
        """Of a sum in brackets, of numbers, names, products of those, and sizes of unions."""
        total = 0
        for term in expression.strip("()").replace("(union ", "(").split(" + "):
            factor, _, name = term.rpartition("*")
            if union := re.fullmatch(r"sizeof\((\w+)\)?", name):
                value = self._union(union[1], within)
            else:
                value = int(name) if re.fullmatch(r"-?\d+", name) else self._value(name, within)
            if value is None:
                return None
            total += int(factor or 1) * value
        return total

    def _union(self, name: str, within: tuple[str, ...]) -> int | None:
        members = re.search(rf"^union {name} {{(.*)}};$", self.text, re.MULTILINE)
        assert members, name
        if name in within:
            return None
        sizes = [self._evaluated(size, (*within, name)) for size in re.findall(r"char f\d+\[(.*?)\];", members[1])]
        return None if None in sizes else max(filter(None, sizes), default=0)


def _nanopb(root: Path, compiled: FileDescriptorSet, files: list[str]) -> _Headers:
    """What nanopb makes of files; raises what it raises."""
    request, response = root / "request", root / "response"
    asked = CodeGeneratorRequest(file_to_generate=files, parameter="-I.", proto_file=compiled.file)
    request.write_bytes(asked.SerializeToString())
    response.write_bytes(b"")
    with (
        inside(root),  # nanopb keeps the folders of former calls, so all calls must call theirs the same
        mock.patch.object(sys, "stdin", _Stream(request, os.O_RDONLY)),
        mock.patch.object(sys, "stdout", _Stream(response, os.O_WRONLY)),
        contextlib.redirect_stderr(io.StringIO()) as complaints,
    ):
        nanopb.main_plugin()
    written = CodeGeneratorResponse.FromString(response.read_bytes()).file
    return _Headers("".join(file.content for file in written if file.name.endswith(".h")), complaints.getvalue())


def _written(root: Path, files: Mapping[str, str]) -> Path:
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8", newline="")
    return root


def _schema(root: Path, files: Mapping[str, str], *flags: str) -> Schema:
    """Return the schema of a.proto, after writing files."""
    return schema_of(_compiled(_written(root, files), ["a.proto"], *flags), "proto")


@dataclass
class _Both:
    """What we and nanopb say of some files."""

    schema: Schema
    bounds: Bounds
    findings: list[Diagnostic]
    headers: _Headers

    def ours(self, message: str) -> int | Unbounded:
        return largest_size(self.schema, self.bounds, message)

    def compare(self, files: list[str], name: str = "{}") -> list[int]:
        """Assert that we say what nanopb says, and return all sizes."""
        messages = [message for message in self.schema.messages.values() if message.file in files]
        sizes = []
        for message in messages:
            ours, in_c = self.ours(message.full_name), name.format(message.full_name).replace(".", "_")
            if message.map_entry and not self.headers.mentions(in_c):
                continue  # of a map that is left out, nanopb leaves out the entry as well
            assert (None if isinstance(ours, Unbounded) else ours) == self.headers.size(in_c), (message.full_name, ours)
            sizes += [ours] if isinstance(ours, int) else []
        return sizes


def _both(root: Path, files: list[str]) -> _Both:
    compiled = _compiled(root, files, "--include_source_info")
    schema, findings = schema_of(compiled, "proto"), list[Diagnostic]()
    bounds = read_bounds(schema, root, "proto", findings)
    return _Both(schema, bounds, findings, _nanopb(root, compiled, files))


def _proto3(body: str, more: str = "") -> str:
    return f'syntax = "proto3"; package p.q; import "nanopb.proto"; {more}\n{body}'


# --- sizes ----------------------------------------------------------------------------------------------------------


def test_our_own_messages_have_the_sizes_that_nanopb_says(tmp_path: Path) -> None:
    """Every message of this repository is as large for us as for nanopb, and needs no bound that it does not have."""
    texts = {path.relative_to(ROOT / "proto").as_posix(): path.read_text() for path in ROOT.glob("proto/**/*.proto")}
    both = _both(_written(tmp_path, texts), sorted(texts))
    assert len(both.compare(sorted(texts))) > 20
    assert not both.findings


@pytest.fixture(scope="module")
def everything(tmp_path_factory: pytest.TempPathFactory) -> _Both:
    """The files beside this one, which have every option that changes a size."""
    root = tmp_path_factory.mktemp("nanopb")
    _written(root, {path.name: path.read_text() for path in _DATA.iterdir()})
    return _both(root, sorted(path.name for path in _DATA.glob("*.proto")))


@pytest.mark.parametrize("file", sorted(path.name for path in _DATA.glob("*.proto")))
def test_every_option_counts_as_it_does_for_nanopb(everything: _Both, file: str) -> None:
    """Scalars, strings, maps, oneofs, recursion, and options at every level have the sizes that nanopb says."""
    assert everything.compare([file])


_MANGLED = "message A { string a = 1; message B { A a = 1; string b = 2; } }"


@pytest.mark.parametrize(
    ("option", "lines", "name"),
    [
        ("mangle_names = M_STRIP_PACKAGE", "A.a max_size:5\nA.B.b max_size:6", "{}"),
        ("mangle_names = M_FLATTEN", "A.a max_size:5\nB.b max_size:6", "{}"),
        ("mangle_names = M_PACKAGE_INITIALS", "pq.A.a max_size:5\npq.A.B.b max_size:6", "pq_{}"),
        ('package = "other.one"', "other.one.A.a max_size:5\nother.one.A.B.b max_size:6", "other_one_{}"),
    ],
)
def test_patterns_match_the_names_that_nanopb_gives(tmp_path: Path, option: str, lines: str, name: str) -> None:
    """Where nanopb shortens names, or puts another package before them, patterns are for those names."""
    text = _proto3(_MANGLED, f"option (nanopb_fileopt).{option};")
    both = _both(_written(tmp_path, {"a.proto": text, "a.options": f"{lines}\np.q.A.a max_size:99"}), ["a.proto"])
    inner = "B" if "FLATTEN" in option else "A_B"
    assert both.ours("p.q.A") == both.headers.size(name.format("A")) == 6
    assert both.ours("p.q.A.B") == both.headers.size(name.format(inner)) == 15
    assert [place.line for _, _, place in both.bounds.unused] == [3]


_REFUSED = [
    'syntax = "proto3"; message M { string a = 1 [(nanopb).type = FT_STATIC]; }',
    'syntax = "proto3"; message M { repeated int32 a = 1 [(nanopb).type = FT_STATIC]; }',
    'syntax = "proto3"; message M { bytes a = 1 [(nanopb).type = FT_INLINE]; }',
    'syntax = "proto3"; message M { bytes a = 1 [(nanopb).fixed_length = true]; }',
    'syntax = "proto3"; message M { bytes a = 1 [(nanopb).fixed_length = true, (nanopb).max_length = 3]; }',
    'syntax = "proto3"; message M { repeated int32 a = 1 [(nanopb).fixed_count = true]; }',
    'syntax = "proto3"; message M { int32 a = 1 [(nanopb).fixed_count = true]; }',
    'syntax = "proto3"; message M { string a = 1 [(nanopb).fallback_type = FT_STATIC]; }',
    'syntax = "proto3"; message M { string a = 1 [(nanopb).fallback_type = FT_IGNORE]; }',
    'syntax = "proto3"; message M { int32 a = 1 [(nanopb).type_override = TYPE_STRING]; }',
    'syntax = "proto3"; message M { int32 a = 1 [(nanopb).type_override = TYPE_BYTES]; }',
    'syntax = "proto3"; message M { int32 a = 1 [(nanopb).type_override = TYPE_MESSAGE]; }',
    'syntax = "proto3"; message M { int32 a = 1 [(nanopb).type_override = TYPE_ENUM]; }',
    'syntax = "proto3"; message N {} message M { N a = 1 [(nanopb).type_override = TYPE_ENUM]; }',
    'syntax = "proto3"; message N {} message M { N a = 1 [(nanopb).type_override = TYPE_GROUP]; }',
    'syntax = "proto2"; message M { optional group A = 1 { required int32 x = 1; } }',
    'syntax = "proto2"; message M { oneof o { group A = 1 { required int32 x = 1; } } }',
]


@pytest.mark.parametrize("text", _REFUSED)
def test_what_nanopb_refuses_has_no_size(tmp_path: Path, text: str) -> None:
    """A message for which nanopb gives up on the whole file has no size, and the field that is to blame is named."""
    text = text.replace(";", '; import "nanopb.proto";', 1)
    compiled = _compiled(_written(tmp_path, {"a.proto": text}), ["a.proto"], "--include_source_info")
    with pytest.raises((Exception, SystemExit)):  # of various types, for various accidents
        _nanopb(tmp_path, compiled, ["a.proto"])
    schema = schema_of(compiled, "")
    size = largest_size(schema, read_bounds(schema, tmp_path, "", []), "M")
    assert isinstance(size, Unbounded)
    assert size.path == "a"
    assert size.span.line == 1


# --- why there is none ----------------------------------------------------------------------------------------------

_FREE = "it is a string without `max_size` or `max_length`"


@pytest.mark.parametrize(
    ("message", "path", "reason", "line"),
    [
        ("lengths.Free", "a", _FREE, 7),
        ("lengths.FreeBytes", "a", "it has the type bytes, without `max_size`", 10),
        ("lengths.FreeCount", "a", "it is repeated, without `max_count`", 56),
        ("lengths.FreeMap", "a", "it is a map, without `max_count`", 69),
        ("lengths.FreeMapValue", "a.value", _FREE, 70),
        ("importing.AroundFreeMember", "b.b.a", _FREE, 7),
        ("storage.Pointer", "a", "its nanopb type is FT_POINTER, which has no buffer of fixed size", 8),
        ("storage.Self", "b", "the message contains itself: storage.Self > storage.Self", 32),
        (
            *("storage.AroundRing", "b.a.b.a"),
            *("the message contains itself: storage.Ring2 > storage.Ring3 > storage.Ring > storage.Ring2", 39),
        ),
        ("storage.Skipped", "", "nanopb leaves the message 'storage.Skipped' out", 49),
        ("storage.AroundSkipped", "a.b", "nanopb leaves the message 'storage.Skipped' out", 54),
    ],
)
def test_the_first_field_without_a_bound_is_named(
    everything: _Both, message: str, path: str, reason: str, line: int
) -> None:
    """A message without a size names the way to a field that is why, and where that stands."""
    size = everything.ours(message)
    assert isinstance(size, Unbounded)
    assert (size.path, size.reason, size.span.line) == (path, reason, line)


def test_what_a_message_consists_of_is_told_by_field(everything: _Both) -> None:
    """The fields of a message come with their sizes, the largest first; all but those that have none."""
    assert field_sizes(everything.schema, everything.bounds, "oneofs.Plain") == [
        *(("c", 203), ("a", 11), ("d", 11), ("e", 11), ("f", 9), ("g", 7), ("b", 2))
    ]
    assert field_sizes(everything.schema, everything.bounds, "lengths.FreeBytes") == [("first", 11)]


@pytest.mark.slow
def test_a_long_chain_of_messages_is_no_trouble(tmp_path: Path) -> None:
    """Sizes come from the innermost message on, so no number of messages in messages is too many."""
    chain = "".join(f"message M{i} {{ M{i + 1} a = 1; }}" for i in range(2000)) + "message M2000 { TYPE a = 1; }"
    for type, expected in (("bool", int), ("string", Unbounded), ("M0", Unbounded)):
        schema = _schema(tmp_path, {"a.proto": f'syntax = "proto3"; {chain.replace("TYPE", type)}'})
        assert isinstance(largest_size(schema, read_bounds(schema, tmp_path, "proto", []), "M0"), expected)


# --- options that cannot be read ------------------------------------------------------------------------------------

_HOST = 'syntax = "proto3"; package p.q; message M { string s = 1; repeated int32 r = 2; }'
_LINES = [
    *("# x", "// x", "  // x", "/* p.q.M.s max_size:5 */", "/**/", "//*", "", " \t", "/*/ x */p.q.M.* max_size:5"),
    *("p.q.M.s max_size:5 # c", "p.q.M.s max_size:5 // c", "p.q.M.s max_size:/* a */5", "p.q.M/**/.s max_size:5"),
    *("p.q.M.s max_size: 5", "p.q.M.s max_size :5", "p.q.M.s max_size:5, max_count:3", "p.q.M.s max_size:5; type:2"),
    *("\tp.q.M.s\tmax_size:5", "p.q.M.s\xa0max_size:5", "p.q.M.s\x0bmax_size:5", "\ufeffp.q.M.s max_size:5"),
    *("p.q.M.* max_size:5 max_size:6", "p.q.M.s max_size:0x10", "p.q.M.s max_size:010", "p.q.M.s max_size:+5"),
    *("p.q.M.* max_size:5 max_count:3", "*.r max_count:4", "p.q.M.* max_size:5\rp.q.M.r max_count:3"),
    *("p.q.M.r fixed_count:t max_count:2", "p.q.M.r fixed_count:1 max_count:2", 'p.q.M.s callback_datatype:"int *"'),
    *('p.q.M.s include:"a" include:"b"', "p.q.M.s include:['a', 'b'] max_size:3", "p.q.M.s int_size:8"),
    *("bogus max_size:3", "p.q.M.[ max_size:5", "p.q.M.[s max_size:5", "p.q.M.*/max_size:5 max_count:2"),
    *("M.s max_size:5", "*/ max_size:4", "p.q.M.s max_size:5 /* # */ max_count:2", "q.M.s max_size:5"),
    *(".p.q.M.s max_size:5", "a max_size:5", "p.q max_size:3", "a.proto max_size:3 max_count:2", "*.proto max_size:3"),
    *("p.q.m.s max_size:3", "p.q.M.s max_size:5\u2028", "p.q.M.s", "p.q.M.s max_size", "p.q.M.s max_size:"),
    *("p.q.M.s max_size:x", "p.q.M.s max_size=5", "p.q.M.s max_sise:5", "p.q.M.s max_size:99999999999"),
    *("p.q.M.s max_size:5.0", "p.q.M.s type:FT_BOGUS", "p.q.M.s type:77", "p.q.M.s [x]:5", "p.q.M.r fixed_count:TRUE"),
    *("/* x", "/*", "p.q.M.s max_size:5 \\", "p.q.M.s {max_size:5}", "p.q.M.s max_size:5 }"),
    *("p.q.M.s callback_datatype:int", 'p.q.M.s callback_datatype:"http://x"', "p.q.M.s max_size:5max_count:3"),
    *("x # a", "p.q.M.s max_size:5,,max_count:3", "p.q.M.s 1:5", "p.q.M.s max_size:5 foo", "p.q.M.*// max_size:5"),
    "p.q.M.s max_size:- 5",
]


@pytest.mark.parametrize("line", _LINES, ids=ascii)
def test_lines_are_read_as_nanopb_reads_them(tmp_path: Path, line: str) -> None:
    """A line that nanopb takes says the same to us; one that it stops at is an error, one without a match a warning."""
    _written(tmp_path, {"a.proto": _HOST, "a.options": line})
    compiled, findings = _compiled(tmp_path, ["a.proto"]), list[Diagnostic]()
    schema = schema_of(compiled, "proto")
    bounds = read_bounds(schema, tmp_path, "proto", findings)
    with contextlib.redirect_stderr(io.StringIO()) as complaints:
        try:
            headers = _nanopb(tmp_path, compiled, ["a.proto"])
        except SystemExit:
            assert [finding.rule.id for finding in findings] == ["NPB101"]
            return
    assert not findings
    assert len(bounds.unused) == ("did not match" in headers.complaints)
    _Both(schema, bounds, findings, headers).compare(["a.proto"])
    assert not complaints.getvalue()


def _found(root: Path, files: Mapping[str, str]) -> list[str]:
    findings: list[Diagnostic] = []
    read_bounds(_schema(root, files), root, "proto", findings)
    return [finding.render() for finding in findings]


def test_findings_say_what_is_wrong_with_a_line(tmp_path: Path) -> None:
    """Each line has a finding of its own, at what is wrong in it; the lines around it are read all the same."""
    lines = ["p.q.M.s", "p.q.M.s max_size:5 max_sise:4", "*.r /* n */ max_count:-1", "*.r max_count:x"]
    assert _found(tmp_path, {"a.proto": _HOST, "a.options": "\n".join(lines)}) == [
        "proto/a.options:1:1: error[NPB101] the pattern 'p.q.M.s' has no options\n"
        "  help: for example, write `p.q.M.s max_size:16`",
        "proto/a.options:2:20: error[NPB101] nanopb has no option 'max_sise'\n  help: did you mean 'max_size'?",
        "proto/a.options:3:1: error[NPB101] the option 'max_count' cannot be -1",
        "proto/a.options:4:15: error[NPB101] Couldn't parse integer: x",
    ]


def test_a_file_that_cannot_be_read_is_a_finding(tmp_path: Path) -> None:
    """Bytes that are no UTF-8, and a folder in a file's place, are findings at the file."""
    _written(tmp_path, {"a.proto": _HOST})
    (tmp_path / "a.options").write_bytes(b"*.s max_size:5 # \xff\n")
    assert _found(tmp_path, {}) == [
        "proto/a.options: error[NPB101] the file cannot be read: it is not UTF-8: invalid start byte"
    ]
    (tmp_path / "a.options").unlink()
    (tmp_path / "a.options").mkdir()
    why = "it is not a regular file, but a folder, a pipe or a device"
    assert _found(tmp_path, {}) == [f"proto/a.options: error[NPB101] the file cannot be read: {why}"]


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        ({"a.proto": _HOST, "a.options": "p.q.M.s max_size:5"}, "proto/a.options"),
        ({"a.proto": _proto3("message M { string s = 1 [(nanopb).max_size = 5]; }")}, "proto/a.proto:2:13"),
        ({"a.proto": _proto3("", "option (nanopb_fileopt).max_size = 5;")}, "proto/a.proto"),
        ({"a.proto": _HOST.replace("string s = 1", "string s = 1 [deprecated = true]")}, ""),
    ],
)
def test_options_without_nanopb_are_one_finding(
    tmp_path: Path, files: Mapping[str, str], expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without nanopb, its options are one finding, which is fatal only if sizes are limited; else all is read."""
    schema, findings = _schema(tmp_path, files, "--include_source_info"), list[Diagnostic]()
    vocabulary.cache_clear()
    monkeypatch.setattr("roverlink.generator.nanopb.vocabulary.find_spec", lambda name: None)
    bounds = [read_bounds(schema, tmp_path, "proto", findings, needed=needed) for needed in (True, False)]
    vocabulary.cache_clear()
    assert (bounds == [None, None]) is bool(expected)
    said = (
        "nanopb is not installed, so its options were not read, and no sizes were checked\n"
        "  help: install nanopb: pip install 'nanopb>=0.4.9,<0.5'"
    )
    levels = ("fatal", "hint") if expected else ()
    assert [finding.render() for finding in findings] == [f"{expected}: {level}[NPB105] {said}" for level in levels]


def _with_options(schema: Schema, options: bytes) -> tuple[Bounds, list[str]]:
    """What is read of a schema whose field ``s`` has some bytes for its options."""
    message = schema.messages["p.q.M"]
    fields = tuple(replace(field, options=options) if field.name == "s" else field for field in message.fields)
    changed = replace(schema, messages={"p.q.M": replace(message, fields=fields)})
    findings: list[Diagnostic] = []
    bounds = read_bounds(changed, Path("nowhere"), "", findings)
    largest_size(changed, bounds, "p.q.M")
    return bounds, [f"{finding.rule.id} {finding.span} {finding.message}" for finding in findings]


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Schema:
    """One message with a string and numbers."""
    return _schema(tmp_path_factory.mktemp("host"), {"a.proto": _HOST}, "--include_source_info")


@pytest.mark.parametrize(
    ("options", "max_size", "said"),
    [
        (b"", None, ""),
        (b"\x18\x01", None, ""),  # deprecated, and nothing of nanopb's
        (b"\x92\x3f\x02\x08\x05", 5, ""),
        (b"\x92\x3f\x02\x08\x05\x18\x01\x92\x3f\x02\x08\x06", 6, ""),  # in two parts
        (b"\x92\x3f\x02\x08", None, "the options are not a protobuf message"),
        (b"\x90\x3f\x05", None, "nanopb's options are not a message"),
        (b"\x92\x3f\x05\x08\x05\x98\x06\x07", 5, "the installed nanopb has no option number 99"),
        (b"\x92\x3f\x04\x08\x05\x18\x4d", 5, "the option 'type' cannot be 77"),
        (b"\x92\x3f\x05\x08\x05\x0a\x01x", 5, "the option 'max_size' cannot be b'x'"),
        (b"\x92\x3f\x0b\x08" + b"\xff" * 9 + b"\x01", None, "the option 'max_size' cannot be -1"),
    ],
)
def test_options_inside_are_read_or_found_fault_with(
    host: Schema, options: bytes, max_size: int | None, said: str
) -> None:
    """Of options in a .proto file, what can be read holds, and what cannot is a finding at the field's options."""
    bounds, findings = _with_options(host, options)
    place = host.messages["p.q.M"].fields[0].span
    assert bounds.of_field("p.q.M", "s").max_size == max_size
    assert findings == ([f"NPB101 {place} {said}"] if said else [])
