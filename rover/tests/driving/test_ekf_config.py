"""rover/navigation/config/ekf.yaml: its topics are those of this project, and its matrices and frames are complete."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml
from roverkit.simulation.rover_sensors import GpsSettings

from generated.registry import REGISTRY

_FILE = Path(__file__).parents[2] / "navigation" / "config" / "ekf.yaml"
_NODES: dict[str, dict[str, Any]] = {
    name.removeprefix("/**/"): node["ros__parameters"]
    for name, node in yaml.load(_FILE.read_bytes(), yaml.CSafeLoader).items()
}
_FILTERS = ("ekf_filter_node_odom", "ekf_filter_node_map")
_STATES = 15


def _inputs(name: str) -> dict[str, str]:
    """The inputs of a filter by their parameters, such as odom0."""
    return {key: value for key, value in _NODES[name].items() if key[:-1] in ("odom", "pose", "twist", "imu")}


@pytest.mark.parametrize("name", _FILTERS)
def test_each_input_has_a_matrix_and_the_numbers_have_no_gap(name: str) -> None:
    """A filter ignores inputs after a gap and ones without a matrix; only poses of markers and GPS do not drift."""
    inputs, parameters = _inputs(name), _NODES[name]
    for kind in {key[:-1] for key in inputs}:
        numbers = sorted(int(key[-1]) for key in inputs if key[:-1] == kind)
        assert numbers == list(range(len(numbers)))
    for key, topic in inputs.items():
        matrix = parameters[f"{key}_config"]
        assert len(matrix) == _STATES
        assert all(type(one) is bool for one in matrix)
        is_absolute = topic in ("aruco/pose", "odometry/gps")
        assert (any(matrix[:6]), any(matrix[6:])) == (is_absolute, not is_absolute)
    for key in parameters.keys() & {"process_noise_covariance", "initial_estimate_covariance"}:
        assert len(parameters[key]) == _STATES**2
        assert all(type(value) is float for value in parameters[key])


def test_the_topics_and_frames_are_those_of_this_project() -> None:
    """The global inputs go to the filter of the frame map alone (REP 105); the datum is that of the simulated rover.

    The launch file adds the camera's IMU, if it is used.
    """
    for name, world in zip(_FILTERS, ("odom", "map"), strict=True):
        frames = [_NODES[name][f"{one}_frame"] for one in ("map", "odom", "base_link", "world")]
        assert (frames, _NODES[name]["publish_tf"]) == (["map", "odom", "base_link", world], True)
    odom, map_ = (_inputs(name) for name in _FILTERS)
    assert set(odom.values()) == {"odometry/wheel", "visual_odometry"}
    assert set(map_.values()) - set(odom.values()) == {"aruco/pose", "odometry/gps"}
    assert odom.items() <= map_.items()
    (extra,) = [one for one in REGISTRY.extra_topics if one.route.name == "rover_localization"]
    assert extra.route.topic == "odometry/global"

    datum = GpsSettings().datum
    assert _NODES["navsat_transform"]["datum"] == [datum.latitude, datum.longitude, 0.0]
    assert _NODES["navsat_transform"]["wait_for_datum"]
