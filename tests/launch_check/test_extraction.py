"""The program that extracts catalogues: facts about a small package, from its sources in a git checkout."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

_ROOT = Path(__file__).parents[2]

_FILES = {
    "package.xml": "<package><name>my_layers</name><version>2.1.0</version></package>",
    "CMakeLists.txt": "project(my_layers)\nset(program my_server)\nadd_executable(${program} src/main.cpp)\n"
    'rclcpp_components_register_nodes(my_core "my_layers::Server")\n',
    "plugins.xml": '<library path="p"><class name="my_layers/Rocks" type="my_layers::Rocks" '
    'base_class_type="nav2_costmap_2d::Layer"><description/></class></library>',
    "src/main.cpp": "int main(int argc, char ** argv) {\n  auto node = std::make_shared<my_layers::Server>();\n}\n",
    "include/my_layers/server.hpp": """
namespace my_layers {
class Base : public rclcpp::Node {
protected:
  double radius_{0.5};
  std::string frame_ = "base_link";
};
class Server : public Base {
  std::unique_ptr<Listener> listener_;
  std::vector<std::string> names_{"a", "b"};
};
class Listener { };
class Rocks : public nav2_costmap_2d::Layer { };
}
""",
    "src/server.cpp": """
// declare_parameter("in_a_comment", 1);
namespace my_layers {
Server::Server(const rclcpp::NodeOptions & options)
: Base("rock_server", options), listener_{nullptr} {
  /* declare_parameter("also_in_a_comment", 1); */
  declare_parameter("radius", radius_);
  this->declare_parameter<int>("count", 3);
  declare_parameter("names", names_);
  declare_parameter("limits", rclcpp::PARAMETER_DOUBLE_ARRAY);
  RCLCPP_INFO(get_logger(), "declare_parameter(\\"in_a_text\\", 1)");
  std::string topic;
  declare_parameter("scan_topic", std::string("scan"));
  get_parameter("scan_topic", topic);
  sub_ = create_subscription<sensor_msgs::msg::LaserScan>(topic, rclcpp::SensorDataQoS(), callback);
  pub_ = create_publisher<nav_msgs::msg::OccupancyGrid>(
    "rocks/map", rclcpp::QoS(rclcpp::KeepLast(1)).transient_local().reliable());
  srv_ = create_service<std_srvs::srv::Empty>("~/clear", callback);
  listener_ = std::make_unique<Listener>(this, "odom");
}
Listener::Listener(rclcpp::Node * node, const std::string & name) {
  nav2_util::declare_parameter_if_not_declared(node, "listen", rclcpp::ParameterValue(true));
  sub_ = node->create_subscription<nav_msgs::msg::Odometry>(name, 10, callback);
}
void Rocks::onInitialize() {
  declareParameter("enabled", rclcpp::ParameterValue(true));
  node->declare_parameter(name_ + ".height" , 0.3f);
  node->declare_parameter("of_the_node", -1);
}
}
""",
}


@pytest.fixture(scope="module")
def catalogue(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The catalogue of a checkout with one package."""
    checkout = tmp_path_factory.mktemp("sources") / "layers"
    for name, text in _FILES.items():
        path = checkout / "my_layers" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    git = ["git", "-C", str(checkout), "-c", "user.name=a", "-c", "user.email=a@example.com"]
    for command in (["init", "-q"], ["add", "."], ["commit", "-q", "-m", "Add a package"]):
        subprocess.run([*git, *command], check=True)
    output = checkout.parent / "humble.json"
    program = [sys.executable, "-m", "roverlink.launch_check.extraction", "--distribution", "humble"]
    subprocess.run([*program, "--output", str(output), str(checkout)], check=True, cwd=_ROOT)
    found: dict[str, Any] = json.loads(output.read_text(encoding="utf-8"))
    return found


def test_packages_have_versions_executables_and_components(catalogue: dict[str, Any]) -> None:
    """Names in CMakeLists.txt are resolved, and main says which node a program is; sources have commits."""
    package = catalogue["packages"]["my_layers"]
    assert (package["version"], package["source"]) == ("2.1.0", "layers")
    assert len(catalogue["sources"]["layers"]["commit"]) == 40
    assert package["executables"] == {"my_server": "my_layers::Server"}
    assert package["components"] == ["my_layers::Server"]


def test_parameters_have_types_and_defaults(catalogue: dict[str, Any]) -> None:
    """Defaults come from literals, members and types; comments and texts declare nothing; members' classes count."""
    facts = catalogue["classes"]["my_layers::Server"]
    assert facts["default_name"] == "rock_server"
    assert facts["parameters"] == {
        "count": {"type": "integer", "default": 3},
        "limits": {"type": "double_array"},
        "listen": {"type": "bool", "default": True},
        "names": {"type": "string_array", "default": ["a", "b"]},
        "radius": {"type": "double", "default": 0.5},
        "scan_topic": {"type": "string", "default": "scan"},
        "use_sim_time": {"type": "bool", "default": False},
    }


def test_topics_have_types_and_qos(catalogue: dict[str, Any]) -> None:
    """A topic may be a text, the value of a parameter, or what the maker of an object gives to it."""
    keys = ("kind", "name", "type", "reliability", "durability")
    assert catalogue["classes"]["my_layers::Server"]["endpoints"] == [
        dict(zip(keys, values))
        for values in (
            ("publisher", "rocks/map", "nav_msgs/msg/OccupancyGrid", "reliable", "transient_local"),
            ("service", "~/clear", "std_srvs/srv/Empty"),
            ("subscription", "$(scan_topic)", "sensor_msgs/msg/LaserScan", "best_effort", "volatile"),
            ("subscription", "odom", "nav_msgs/msg/Odometry", "reliable", "volatile"),
        )
    ]


def test_plugins_have_parameters_under_their_names(catalogue: dict[str, Any]) -> None:
    """Parameters that begin with the plugin's name are its own; the others are the node's."""
    assert catalogue["plugins"]["my_layers/Rocks"]["base"] == "nav2_costmap_2d::Layer"
    facts = catalogue["classes"]["my_layers::Rocks"]
    own = {"enabled": {"type": "bool", "default": True}, "height": {"type": "double", "default": 0.3}}
    assert facts["parameters"] == own
    assert facts["of_node"] == {"of_the_node": {"type": "integer", "default": -1}}
