"""The native core: what Python knows of its interface, reasons why there is none, and cases of the wire format.

The cases are those that protobuf's conformance suite lists. The judge is libprotobuf: what it refuses, the core hands
over; what it accepts, the core translates to what the handler makes of it.
"""

from __future__ import annotations

import ctypes
import re
import runpy
import shutil
import struct
import subprocess
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from google.protobuf.message import DecodeError
from native_wire_cases import ACCEPTED, HANDED_OVER, OTHERS, field, wire_project
from needs import needs_native

from generated.registry import REGISTRY
from roverlink.runtime import ConversionError
from roverlink.runtime.bridge.limited_row import Pacer
from roverlink.runtime.core.handler import UNSTAMPED
from roverlink.runtime.core.signing import SigningClock, Stream
from roverlink.runtime.core.tap import Sources
from roverlink.runtime.native import bridge_layout, core, layout
from roverlink.runtime.native.core import open_core
from roverlink.runtime.native.observer_ring import ObserverRing
from roverlink.runtime.native.operations import PRIMITIVES
from roverlink.runtime.net.sources import Source

_ROOT = Path(__file__).parents[2]
_HEADER = _ROOT / "native" / "include" / "roverlink" / "native.h"
_NAMES = {"MiddlewareFunctions": "middleware", "ServingCalls": "serving_calls"}
_OF_KEY = {name: f"key.{name}" for name in ("id", "secret", "last")}
_MEMBERS: dict[str, dict[str, str]] = {
    "rl_signer": _OF_KEY,
    "rl_stream": {**_OF_KEY, "link": "clock"},
    "rl_clock": {"last": "now.last", "offset": "now.offset", "shared_lock": "lock"},
    "rl_pacer": {"shared_lock": "lock"},
}
"""Members of structs of Python that have another name in the header."""
_PLACES = """#include <cstddef>
#include <cstdio>
#include "roverlink/bridge.h"
#define SIZE(type, member) sizeof(static_cast<type *>(nullptr)->member)
#define PLACE(type, member) std::printf("%zu+%zu\\n", offsetof(type, member), SIZE(type, member))
int main() {{
{}
}}
"""
_ENUMS = {
    "rl_code": layout.Code,
    "rl_op_flag": layout.Flag,
    "rl_field_flag": layout.FieldFlag,
    "rl_number": layout.Number,
    "rl_expression_flag": layout.ExpressionFlag,
}


def _options() -> tuple[list[str], list[str]]:
    """The flags of the build, and those with the folders of headers."""
    pytest.importorskip("hatchling")
    build = runpy.run_path(str(_ROOT / "hatch_build.py"))
    return [f"@{_ROOT / build['FLAGS']}"], [f"-I{_ROOT / folder}" for folder in build["INCLUDES"]]


def _header() -> str:
    return re.sub(r"/\*.*?\*/", "", _HEADER.read_text(encoding="utf-8"), flags=re.DOTALL)


def test_python_describes_the_interface_that_the_header_declares() -> None:
    """The same names with the same numbers."""
    header = _header()
    assert int(re.search(r"RL_INTERFACE (\d+)", header)[1]) == layout.INTERFACE  # type: ignore[index]
    for name, enum in _ENUMS.items():
        declared, number = {}, 0
        for one in re.search(rf"enum {name} {{(.*?)}}", header, re.DOTALL)[1].split(","):  # type: ignore[index]
            if one.strip():
                key, _, value = one.partition("=")
                number = int(value) if value else number
                declared[key.strip().removeprefix("RL_")] = number
                number += 1
        last = max(declared, key=lambda key: declared[key])
        if last.endswith("S") and last not in enum.__members__:
            del declared[last]  # the number of values
        assert declared == {one.name: one.value for one in enum}, name
    (primitives,) = re.findall(r"enum rl_primitive {(.*?) RL_PRIMITIVES", header.replace("\n", " "))
    assert [one.strip().removeprefix("RL_").lower() for one in primitives.split(",")][:-1] == list(PRIMITIVES)


def test_structs_have_the_members_of_the_headers_at_the_same_places(tmp_path: Path) -> None:
    """A C++ compiler says where each member of a struct of ctypes is in the headers, and how large it is."""
    if shutil.which("g++") is None:
        pytest.skip("need g++ (apt-get install g++)")
    structs = {
        f"rl_{_NAMES.get(name, name.lower())}": struct
        for module in (layout, bridge_layout)
        for name, struct in vars(module).items()
        if isinstance(struct, type(ctypes.Structure)) and struct.__module__ == module.__name__
    }
    structs |= {"rl_clock": SigningClock, "rl_stream": Stream, "rl_bucket": Source, "rl_pacer": Pacer}
    assert len(structs) == 26
    members = [(struct, name) for struct, made in structs.items() for name, *_ in made._fields_]
    lines = [f"PLACE({struct}, {_MEMBERS.get(struct, {}).get(name, name)});" for struct, name in members]
    lines += [f'std::printf("%zu\\n", sizeof({struct}));' for struct in structs]
    source = tmp_path / "places.cpp"
    source.write_text(_PLACES.format("\n".join(lines)), encoding="utf-8")
    subprocess.run(["g++", *_options()[1], "-o", source.with_suffix(""), source], check=True)
    told = subprocess.run([source.with_suffix("")], capture_output=True, text=True, check=True).stdout.split()
    places = [f"{place.offset}+{place.size}" for struct, name in members for place in [getattr(structs[struct], name)]]
    assert told == [*places, *(str(ctypes.sizeof(made)) for made in structs.values())]


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_compilers_have_nothing_to_say(compiler: str) -> None:
    """With all the warnings that the build asks for."""
    if shutil.which(compiler) is None:
        pytest.skip(f"need {compiler} (apt-get install g++ clang)")
    flags, includes = _options()
    sources = sorted(_ROOT.glob("native/src/*.cpp"))
    command = [compiler, *flags, "-Werror", "-Wno-unused-command-line-argument", "-fsyntax-only", *includes, *sources]
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


@needs_native
def test_the_sample_table_is_native() -> None:
    """Every row and every extra topic."""
    assert core.open_core(REGISTRY).unsupported == {}


@needs_native
def test_there_is_one_reason_why_there_is_no_core(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The library is missing, is none, or was built from other sources; or the generated file is not readable."""

    def reason(path: Path) -> str:
        with pytest.raises(core.NoCoreError) as raised:
            core.load_library(path)
        return str(raised.value)

    assert reason(tmp_path / "none.so").startswith("the native library is not installed; install roverlink again")
    (tmp_path / "text.so").write_text("no library")
    assert "cannot be loaded" in reason(tmp_path / "text.so")
    monkeypatch.setattr(layout, "INTERFACE", layout.INTERFACE + 1)
    assert f"has interface {layout.INTERFACE - 1}, not {layout.INTERFACE}; " in reason(core.LIBRARY)
    with pytest.raises(
        core.NoCoreError, match=r"translations.json is not that of the table .*run `roverlink generate`"
    ):
        core.NativeCore(REGISTRY, {"messages": {}}, ctypes.CDLL(None))


@needs_native
def test_observers_get_what_they_want_of_a_ring() -> None:
    """All messages of their channels in order, or the newest alone."""
    messages = [(number % 3, bytes([number]) * number) for number in range(20)]
    records = b"".join(
        struct.pack("=IIq", len(data), channel, len(data)) + data + bytes(-len(data) % 8) for channel, data in messages
    )
    seen: dict[str, list[Any]] = {"all": [], "newest": [], "nothing": []}

    def tap(name: str, **marks: Any) -> Any:
        take = partial(lambda given, times: seen[name].extend(zip(given, times)))
        vars(take).update(marks)
        return take

    reader = Sources()
    taps = {0: [tap("all")], 1: [tap("newest", sources=reader)], 4: [tap("nothing", sources=reader)]}
    ring = ObserverRing(core.open_core(REGISTRY), taps, "ring")
    ctypes.memmove(ring.struct.memory, records, len(records))
    ring.struct.written = len(records)
    with ring:
        reader()
    assert seen["all"] == [(data, len(data)) for channel, data in messages if channel == 0]
    assert (seen["newest"], seen["nothing"]) == ([(bytes([19]) * 19, 19)], [])


@pytest.fixture(scope="module")
def translated(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, bytes], tuple[bytes | None, bytes | None]]:
    """Function that translates a payload: by the core, and by libprotobuf and the handler."""
    registry = wire_project(tmp_path_factory.mktemp("wire"))
    core = open_core(registry)
    assert not core.unsupported

    def translate(name: str, data: bytes) -> tuple[bytes | None, bytes | None]:
        handler = registry.by_name[name]
        try:
            theirs = handler.to_cdr(handler.payload_type.FromString(data))
        except (DecodeError, ConversionError):
            theirs = None
        return core.to_cdr(handler, data, UNSTAMPED), theirs

    return translate


@needs_native
@pytest.mark.slow
def test_what_libprotobuf_accepts_is_translated(translated: Any) -> None:
    """To the same message, in the same bytes."""
    wrong = {
        case: found
        for case, data in ACCEPTED.items()
        if None in (found := translated("wire", data)) or found[0] != found[1]
    }
    assert not wrong
    for case, data in OTHERS.items():
        ours, theirs = translated("wire", data)
        assert ours in (None, theirs), case


@needs_native
@pytest.mark.slow
def test_what_libprotobuf_refuses_is_handed_over(translated: Any) -> None:
    """Python then says what is wrong with it."""
    wrong = {case: found for case, data in HANDED_OVER.items() if (found := translated("wire", data)) != (None, None)}
    assert not wrong


@needs_native
@pytest.mark.slow
def test_what_no_program_uses_must_be_well_formed_too(translated: Any) -> None:
    """Required fields, extensions, and messages that contain themselves, as deep as protobuf reads them at least."""
    for data in (field(1, 1), field(2, 1)):
        ours, theirs = translated("required", data)
        assert ours == theirs is not None
    nested = b""
    for depth in range(200):
        for wrong in (b"", b"\x08"):
            ours, theirs = translated("tree", field(1, 3) + nested + wrong)
            assert ours == theirs or (ours is None and depth > 30), (depth, wrong)
        nested = field(2 + depth % 2, nested)
    for note in (b"text", b"\xff", 1):
        ours, theirs = translated("tree", field(100, note))
        assert ours in (None, theirs)
        assert ours is None or theirs is not None
