"""The packages of a workspace: the check reads their nodes from the sources, and keeps what it has read."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from roverlink.__main__ import main

_TWO = ("tags", "tags2")
_FILES = {
    "README.md": "ROS 2 Foxy",
    "src/arm/package.xml": "<package><name>arm</name><build_type>ament_python</build_type></package>",
    "src/arm/CMakeLists.txt": "add_executable(drivr src/drivr.cpp)",
    "src/arm/setup.py": "setup(entry_points={'console_scripts': "
    "['driver = ' 'arm.driver:main', 'other = arm.other:main']})",
    "src/arm/arm/__init__.py": "",
    "src/arm/arm/names.py": "EXECUTABLE = 'drivr'\n",
    "src/arm/arm/driver.py": """
from rclpy.node import Node
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import JointState
class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.parts[0] = True
        declare = self.declare_parameter
        declare('rate', 10.0)
        self.declare_parameters('joint', [('names', ['a', 'b'])])
        self.topic = self.declare_parameter('topic', 'joints').value
        self.publisher = self.create_publisher(JointState, self.topic, 10)
        qos = QoSProfile(depth=1)
        qos.durability = DurabilityPolicy.TRANSIENT_LOCAL
        self.map = self.create_publisher(OccupancyGrid, '/map', qos)
def main():
    Driver()
""",
    "src/arm/arm/other.py": """
from rclpy.node import Node
from elsewhere import Helper
class Other(Node):
    def __init__(self):
        super().__init__('other')
        self.helper = Helper(self)
def main():
    Other()
""",
    "src/base/package.xml": "<package><name>base</name><version>1.0.0</version>"
    "<!-- <build_type>ament_python</build_type> --><export><build_type>ament_cmake</build_type></export></package>",
    "src/base/setup.py": "setup(entry_points={'console_scripts': ['wheels = base.other:main']})",
    "src/base/CMakeLists.txt": "project(base)\nadd_executable(wheels src/wheels.cpp)\n"
    "generate_parameter_library(base_parameters src/base_parameters.yaml)\n",
    "src/base/src/base_parameters.yaml": "base:\n"
    "  radius: {type: double, default_value: 0.1, validation: {bounds<>: [0.01, 1.0]}}\n",
    "src/base/src/wheels.cpp": """
#include "base_parameters.hpp"
namespace base {
template<typename T> class TypedWheels : public rclcpp::Node {
  std::shared_ptr<base::ParamListener> listener_;
  TypedWheels(rclcpp::NodeOptions options = rclcpp::NodeOptions()) : rclcpp::Node("wheels", options) {
    declare_parameter("width", 0.3);
  }
};
using Wheels = TypedWheels<double>;
}
struct Clock {};
int main() {
  auto clock = std::make_shared<base::Clock>();
  rclcpp::spin(std::make_shared<base::Wheels>(clock));
}
""",
    "src/cart/package.xml": "<package><name>cart</name><version>1.0.0</version></package>",
    "src/cart/CMakeLists.txt": "project(cart)\nadd_executable(wheels src/wheels.cpp)\n"
    "rover_program(brake src/brake.cpp)\ninclude(cmake/horn.cmake)\n",
    "src/cart/cmake/horn.cmake": "ADD_EXECUTABLE(horn src/horn.cpp)\n",
    "src/cart/src/wheels.cpp": """
namespace base {
class Rim : Tyre {};
class Tyre : Rim {};
class Wheels : public rclcpp::Node {
  Rim rim_;
  Wheels() : Node("wheels") { declare_parameter<float>("spoke", 3); auto node = this; elsewhere(node, "hub"); }
};
}
int main() { rclcpp::spin(std::make_shared<base::Wheels>()); }
""",
    **{f"src/{one}/package.xml": "<package><name>tags</name></package>" for one in _TWO},
    **{f"src/{one}/CMakeLists.txt": "rclcpp_components_register_nodes(tags Tags)" for one in _TWO},
    **{f"src/{one}/a.cpp": 'class Tags : public rclcpp::Node { Tags() : Node("tags") {} };' for one in _TWO},
    "src/cart/tmux/rover_launch.yaml": "session_name: rover\n",
    "src/base/launch/a.launch.py": """
from arm.names import EXECUTABLE
from launch import LaunchDescription
from launch.actions.declare_launch_argument import DeclareLaunchArgument
from launch_ros.actions import ComposableNodeContainer, Node
from launch_ros.descriptions import ComposableNode
from lifecycle_msgs.msg import Transition
import ament_index_python, os, xacro
def generate_launch_description():
    robot, prefixes = xacro.process_file('').toxml(), map(os.path.basename, ament_index_python.get_search_paths())
    return LaunchDescription([
        *[Node(package='arm', executable=EXECUTABLE) for _ in {'arm'}.intersection(prefixes)],
        Node(package='arm', executable='driver', parameters=[{'rte': 5.0}, {'joint.names': ['c']}, {'topic': 'a'}]),
        Node(package='arm', executable='other', parameters=[{'anything': 5.0}, {'a', 'b'}]),
        Node(package='base', executable='wheels', parameters=[{'radius': 5.0}, {'radus': 0.2}, {'width': 1}]),
        Node(package='cart', executable='wheels', parameters=[{'spoke': 5.0}, {'radius': 0.2}, {'hub': 1}]),
        Node(package='cart', executable='brake'), Node(package='cart', executable='horn'),
        ComposableNodeContainer(package='rclcpp_components', executable='component_container', name='c', namespace='',
            composable_node_descriptions=[ComposableNode(package='tags', plugin='Tags', parameters=[{'a': 1}])]),
        Node(package='nav2_amcl', executable='amcl', name='amcl'),
    ])
""",
}
_EXPECTED = [
    ("LCH108", 12),
    ("LCH111", 14),
    ("PAR101", 13),
    ("PAR101", 15),
    ("PAR102", 16),
    ("PAR103", 15),
    ("PAR104", 15),
]


@pytest.mark.slow
def test_own_packages_are_read_first(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Nodes in Python and C++ have the parameters that they declare; a node that gives itself away may have more.

    The facts are kept in a file, and read again if a source has changed.
    """
    for name, text in _FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    driver, facts = tmp_path / "src/arm/arm/driver.py", tmp_path / "facts.json"

    def findings() -> list[tuple[str, int]]:
        main(
            ["check-launch", "--format", "json", "--packages", str(tmp_path), "--catalogue", str(facts), str(tmp_path)]
        )
        found = json.loads(capsys.readouterr().out)
        return sorted((one["id"], one["line"]) for one in found if one["severity"] in ("fatal", "error", "warning"))

    assert findings() == _EXPECTED
    kept = facts.read_bytes()
    assert findings() == _EXPECTED
    assert facts.read_bytes() == kept
    driver.write_text(driver.read_text().replace("'rate'", "'rte'"))
    assert findings() == [one for one in _EXPECTED if one != ("PAR101", 13)]
