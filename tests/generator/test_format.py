"""The JSON Schema that editors use, and the reader that generate uses, take and refuse the same tables."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml
from golden import ROOT, case, files_of, passing_cases

from generated.registry import REGISTRY
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.engine import lint
from roverlink.generator.lock import Ledger
from roverlink.generator.protos.schema import Schema
from roverlink.generator.table import reader
from roverlink.runtime.ros_arguments import parameters


@cache
def _validator() -> Any:
    import jsonschema  # here, not where tests are collected: it takes a tenth of a second

    schema = json.loads(files_of(passing_cases()[0])["generated/mapping.schema.json"])
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


_OWN = yaml.load((ROOT / "mapping.yaml").read_bytes(), yaml.CSafeLoader)
"""The table of this repository."""


def _written(folder: Path, table: Any) -> Path:
    (folder / "mapping.yaml").write_text(yaml.safe_dump(table), encoding="utf-8")
    return folder / "mapping.yaml"


@pytest.mark.slow
def test_it_accepts_what_compiles() -> None:
    """The table of this repository, and that of every case that compiles, is valid."""
    tables = {one.name: yaml.safe_load(one.inputs["mapping.yaml"]) for one in passing_cases()}
    tables["this project"] = _OWN
    refused = {name: list(_validator().iter_errors(table)) for name, table in tables.items()}
    assert {name: errors for name, errors in refused.items() if errors} == {}


def _change(**changes: Any) -> Callable[[dict[str, Any]], None]:
    return lambda table: table["messages"][0].update(changes)


_CHANGES: dict[str, Callable[[dict[str, Any]], None]] = {
    "a number as text": _change(number="13"),
    "a number too large": _change(number=2**29),
    "no number": lambda table: table["messages"][0].pop("number"),
    "no rows": lambda table: table.update(messages=[]),
    "rows as a mapping": lambda table: table.update(messages={}),
    "an unknown key": _change(topik="x"),
    "an unknown key at the top": lambda table: table.update(message=[]),
    "a name with a space": _change(name="imu info"),
    "a name that starts with an underscore": _change(name="_imu"),
    "an empty topic": _change(topic=""),
    "a topic that is a number": _change(topic=17),
    "an unknown reliability": _change(qos={"reliability": "sometimes"}),
    "a depth of nothing": _change(qos={"depth": 0}),
    "a presence that is a text": _change(presence={"x": "yes"}),
    "an Any that holds nothing": _change(any={"x": []}),
    "an Any that holds a type twice": _change(any={"x": ["A", "A"]}),
    "a peer twice": _change(forward=["basestation", "basestation"]),
    "an owner that does not exist": lambda table: table["envelope"].update(owner="nobody"),
    "an envelope outside of the root": lambda table: table["envelope"].update(file="../envelope.proto"),
    "a port too large": lambda table: table["peers"]["hardware"].update(port=65_536),
    "a flag that is a number": lambda table: table["peers"]["hardware"].update(strip_trailing_zeros=1),
    "another version": lambda table: table.update(version=2),
}


@pytest.mark.parametrize("change", _CHANGES.values(), ids=_CHANGES.keys())
def test_schema_and_reader_agree(change: Callable[[dict[str, Any]], None], tmp_path: Path) -> None:
    """A mistake in this repository's table is one to both."""
    table = deepcopy(_OWN)
    change(table)
    assert not _validator().is_valid(table)
    findings: list[Diagnostic] = []
    with contextlib.suppress(DiagnosticsError):
        reader.read(_written(tmp_path, table), findings)
    assert findings


def test_no_peer_takes_a_parameter_of_the_node(tmp_path: Path) -> None:
    """Every parameter that the node has for itself is refused as a peer's."""
    ports = {peer.port_parameter for peer in REGISTRY.peers}
    own = sorted(set(parameters.defaults(REGISTRY)) - ports)
    table = yaml.safe_load(case("nested").inputs["mapping.yaml"])
    table["peers"] |= {f"peer_{name}": {"parameter": name} for name in own}
    findings = lint(Context(reader.read(_written(tmp_path, table), []), Schema(), Ledger()))
    refused = "".join(finding.message for finding in findings if finding.rule.id == "TAB104")
    assert [name for name in own if f" '{name}' of the peer 'peer_{name}' " not in refused] == []
