"""Programs that use rows of the table say which one a table lacks."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module

import pytest
from needs import NO_OPENCV

from generated.messages import DrivingBoardMotorMessage
from generated.registry import REGISTRY
from roverlink.runtime.core.errors import SetupError


@pytest.mark.parametrize(
    ("module", "rows", "missing", "wrong", "fields"),
    [
        ("driving.drive_rows", "DriveRows", "control_mode", "control_mode", "mode"),
        ("odometry.odometry_rows", "OdometryRows", "drive_progress", None, None),
        ("rocks.rock_rows", "RockRows", "rock_measure_request", "rock_measure_result", "length_cm, width_cm"),
        ("objects.object_rows", "ObjectSelectionRow", "object_selection", "object_selection", "object_id"),
        ("simulation.rover_datagrams", "RoverDatagrams", "drive_diag", None, None),
    ],
)
def test_a_table_without_the_rows_is_refused(
    module: str, rows: str, missing: str, wrong: str | None, fields: str | None
) -> None:
    """The message names the row, or the field that its message lacks."""
    pytest.importorskip("cv2", reason=NO_OPENCV)
    rows_of = getattr(import_module(f"roverkit.{module}"), rows)
    others = tuple(handler for handler in REGISTRY.handlers if handler.route.name != missing)
    with pytest.raises(SetupError, match=f"the table has no row '{missing}' in the direction from a peer"):
        rows_of(replace(REGISTRY, handlers=others))
    if wrong is None:
        return

    class Handler(type(REGISTRY.by_name[wrong])):  # type: ignore[misc]  # a class of the registry's
        message_type = DrivingBoardMotorMessage

    changed = tuple(Handler() if handler.route.name == wrong else handler for handler in REGISTRY.handlers)
    with pytest.raises(SetupError, match=f"has no field {fields}; add it"):
        rows_of(replace(REGISTRY, handlers=changed))
