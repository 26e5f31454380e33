"""Wire cases of the native core, those that protobuf's conformance suite lists. The judge is libprotobuf.

What libprotobuf refuses, the core hands over. What it accepts, the core translates to what the handler makes of it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from google.protobuf.message import DecodeError
from native_wire_cases import ACCEPTED, HANDED_OVER, OTHERS, field, wire_project
from needs import needs_native

from roverlink.runtime import ConversionError
from roverlink.runtime.core.handler import UNSTAMPED
from roverlink.runtime.native.core import open_core


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
