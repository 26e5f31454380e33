"""The examples of Nav2, RTAB-Map, RealSense, robot_localization, STVL and the IMU filter: no false finding.

The tests run if the environment variable ROVERLINK_LAUNCH_EXAMPLES names a folder with the folders `humble` and
`jazzy`, each with the checkouts from which the catalogue was extracted (`roverlink check-launch --list`).
The examples have mistakes, which were compared with the sources. They are listed here by what the findings say.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from check_launch.catalogue.catalogue_files import read_catalogue
from check_launch.expansion.launch_context import Packages
from check_launch.rules.checking import Checker, files_to_check

_FOLDER = os.environ.get("ROVERLINK_LAUNCH_EXAMPLES", "")
_EXAMPLES = {
    "navigation2/nav2_bringup": ("launch", "params"),
    "rtabmap_ros": ("rtabmap_launch", "rtabmap_demos", "rtabmap_examples"),
    "realsense-ros/realsense2_camera": ("examples", "launch"),
    "robot_localization": ("launch", "params"),
    "imu_tools/imu_filter_madgwick": ("launch", "config"),
    "stvl/spatio_temporal_voxel_layer": ("example",),
}
_MISTAKES = (
    r"'FollowPath\.stateful'",  # only goal checkers have it
    r"_nodelay'|'stamped_control'|'broadcast_utm_transform_as_parent_frame'",  # of ROS 1; the last one ends with _ now
    r"'static_layer\.map_subscribe_transient_local'",  # nav2_multirobot_params: the local costmap has no static layer
    r"map_server has no parameter 'save_map_timeout'",  # the map saver has it
    r"'Grid/FromDepth'|'Icp/PM'|'map_negative_poses_ignored'|'scan_normal_k'",  # renamed in RTAB-Map
    r"icp_odometry has no parameter '(approx_sync|topic_queue_size|sync_queue_size)'",
    r"ComplementaryFilterROS has no parameter 'world_frame'",  # Madgwick's filter has it
    r"rs_launch\.py has no argument 'rgb_camera\.profile'",  # rgb_camera.color_profile since 4.55
    r"'rgbd_obstacle_layer\.origin_z'",  # Nav2's voxel layer has it, STVL does not
    r"docking_server has no parameter 'controller\.simulation_step'",  # simulation_time_step
    r"\d+ of these libraries are loaded already",  # in files of humble: the behavior trees of jazzy load Nav2's own
    # parameters of jazzy in a file of humble, and the reverse; plugins of jazzy have :: in their names
    r"has no parameter '(local|global)_(costmap|footprint)_topic'|has no parameter '(costmap|footprint)_topic'",
    r"has no parameter '(progress_checker_plugins?|navigators|error_code_names|local_frame)'",
    r"has no parameter 'navigate_(to_pose|through_poses)\.plugin'",
    r"unknown plugin 'nav2_(navfn_planner|behaviors)/\w+'",
)


@pytest.mark.exhaustive
@pytest.mark.skipif(not _FOLDER, reason="ROVERLINK_LAUNCH_EXAMPLES names no folder with the examples of other projects")
@pytest.mark.parametrize("distribution", ["humble", "jazzy"])
def test_the_examples_of_others_have_only_real_mistakes(distribution: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every finding in an example is a mistake of the example."""
    top = Path(_FOLDER) / distribution
    monkeypatch.chdir(top)
    missing: list[Path] = []
    folders = [top / package / folder for package, names in _EXAMPLES.items() for folder in names]
    files = list(files_to_check(folders, missing.append))
    findings = Checker(read_catalogue(distribution), Packages([top])).check(files, {}).findings
    others = [
        one.render()
        for one in findings
        if one.severity.value != "hint" and not any(re.search(known, one.message) for known in _MISTAKES)
    ]
    assert others == []
    assert missing == []
    assert len(files) > 50
