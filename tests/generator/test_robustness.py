"""Whatever is in the files that people edit, the generator finds fault with it or takes it; it never falls over."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import re
from collections.abc import Callable
from typing import Any, TypeVar

import pytest
from golden import ROOT
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from roverlink import generator
from roverlink.generator import lock
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError
from roverlink.generator.table import reader

T = TypeVar("T")

_EXAMPLES = settings(max_examples=40, suppress_health_check=list(HealthCheck))
_TABLE = re.sub(rb"  - number: 4\n.*(?=  - number: 11\n)", b"", (ROOT / "mapping.yaml").read_bytes(), flags=re.DOTALL)
_LEDGER = (ROOT / "mapping.lock").read_bytes()
_SNIPPETS = st.sampled_from(
    [
        *(b":", b"-", b"[", b"]", b"{", b"}", b"*a", b"&a ", b"!!int ", b"? ", b"| ", b"> ", b"'", b'"', b"#", b"%"),
        *(b"<<: ", b"---\n", b"...\n", b"~", b"0", b"012", b"off", b"9" * 30, b"\t", b"\n"),
        *(b"\xff", b"\x00", b"\xc3\xa4", b"\xe2\x80\xa8"),
    ]
)


@st.composite
def _mutated(draw: st.DrawFn, text: bytes) -> bytes:
    """The text after a few edits, as a tired person or a bad merge makes them."""
    lines = text.splitlines(keepends=True)
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, max(0, len(lines) - 1)))
        edit = draw(st.sampled_from(["delete", "repeat", "indent", "insert", "cut", "byte", "move"]))
        if not lines:
            break
        column = draw(st.integers(0, len(lines[at])))
        if edit == "delete":
            del lines[at]
        elif edit == "repeat":
            lines.insert(at, lines[at])
        elif edit == "indent":
            lines[at] = b"  " + lines[at]
        elif edit == "insert":
            lines[at] = lines[at][:column] + draw(_SNIPPETS) + lines[at][column:]
        elif edit == "cut":
            lines[at] = lines[at][:column]
        elif edit == "byte":
            lines[at] = lines[at][:column] + draw(st.binary(min_size=1, max_size=1)) + lines[at][column + 1 :]
        else:
            lines.insert(draw(st.integers(0, len(lines) - 1)), lines.pop(at))
    return b"".join(lines)


def _outcome(function: Callable[..., T], *arguments: Any) -> tuple[T | None, tuple[Diagnostic, ...]]:
    """What a function gives, or the findings that it raises."""
    try:
        return function(*arguments), ()
    except DiagnosticsError as error:
        return None, error.findings


@pytest.mark.slow
@_EXAMPLES
@given(_mutated(_TABLE))
def test_any_table_is_read_or_found_fault_with(tmp_path_factory: pytest.TempPathFactory, text: bytes) -> None:
    """Edits of this repository's table, cut short for speed, give a table or findings with their places."""
    file = tmp_path_factory.getbasetemp() / "mutated.yaml"
    file.write_bytes(text)
    reported: list[Diagnostic] = []
    table, findings = _outcome(reader.read, file, reported, "mapping.yaml")
    assert {finding.span.file for finding in findings} == (set() if table else {"mapping.yaml"})
    assert table is None or table.whole == (not reported)


@pytest.mark.slow
@_EXAMPLES
@given(st.one_of(_mutated(_LEDGER), st.binary(max_size=200)))
def test_any_ledger_is_read_or_found_fault_with(tmp_path_factory: pytest.TempPathFactory, text: bytes) -> None:
    """Edits of this repository's ledger give a ledger, or findings with their places, and nothing else."""
    file = tmp_path_factory.getbasetemp() / "mutated.lock"
    file.write_bytes(text)
    findings: list[Diagnostic] = []
    read_back = lock.read(file, findings)
    unchanged = file.read_bytes() == _LEDGER
    assert {finding.span.file for finding in findings} <= {"mapping.lock"}
    assert not unchanged or (read_back.entries and not findings)


@pytest.mark.parametrize(
    "name", [module.name for module in pkgutil.walk_packages(generator.__path__, "roverlink.generator.")]
)
def test_examples_in_docstrings_are_true(name: str) -> None:
    """What a docstring shows is what happens."""
    assert doctest.testmod(importlib.import_module(name)).failed == 0
