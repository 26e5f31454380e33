"""The JSON Schemas of payloads take what `roverlink listen` prints, and nothing else."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import pytest
from golden import ROOT
from payloads import random_payload

from generated.registry import REGISTRY
from roverlink.generator.pipeline import compile_table
from roverlink.runtime.text.values import payload_to_values


@cache
def _schemas() -> dict[str, Any]:
    """The schema of each row of this repository's table, by the row's name."""
    files = compile_table(ROOT / "mapping.yaml", ["jsonschema"]).files
    return {
        Path(path).stem: json.loads(text) for path, text in files.items() if path.startswith("generated/jsonschema")
    }


@cache
def _validator(name: str) -> Any:
    import jsonschema  # here, not where tests are collected: it takes a tenth of a second

    jsonschema.Draft202012Validator.check_schema(_schemas()[name])
    return jsonschema.Draft202012Validator(_schemas()[name])


@pytest.mark.parametrize("name", [handler.route.name for handler in REGISTRY.handlers])
def test_a_schema_takes_every_payload_of_its_row(name: str) -> None:
    """Random payloads, as they are printed, are what the schema of their row describes."""
    random = Random(name)  # noqa: S311  # for values, not for secrets
    for _ in range(20):
        values = payload_to_values(random_payload(REGISTRY.by_name[name].payload_type, random))
        assert [error.message for error in _validator(name).iter_errors(json.loads(json.dumps(values)))] == []


_NO_PAYLOADS = [
    *({"accel": 1.0}, {"accel_x": "fast"}, {"error_code": 2**32}, {"error_code": 0.5}, {"is_calibrated": 1}),
    *({"state": "NO_SUCH_STATE"}, []),
]


@pytest.mark.parametrize("values", _NO_PAYLOADS)
def test_a_schema_refuses_what_is_no_payload(values: object) -> None:
    """Unknown fields, values of another kind, and values out of range are refused."""
    assert not _validator("imu_info").is_valid(values)
