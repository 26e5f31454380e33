"""The program that extracts catalogues: facts about a small package, from its sources in a git checkout."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import pytest
from check_launch.extraction.__main__ import main

_FILES = {
    "package.xml": "<package><name>my_layers</name><version>2.1.0</version></package>",
    "CMakeLists.txt": "project(my_layers)\nset(program my_server)\nadd_executable(${program} src/main.cpp)\n"
    "add_executable(my_listener src/listen.cpp)\n"
    'rclcpp_components_register_nodes(my_core "Server")\n',
    "plugins.xml": '<library path="p"><class name="my_layers/Rocks" type="my_layers::Rocks" '
    'base_class_type="nav2_costmap_2d::Layer"><description/></class></library>',
    "src/main.cpp": "int main(int argc, char ** argv) {\n  auto node = std::make_shared<my_layers::Server>();\n}\n",
    "src/listen.cpp": "int main(int argc, char ** argv) {\n  my_layers::Listener listener;\n}\n",
    "../corelib/include/rtabmap/core/Parameters.h": 'RTABMAP_PARAM(Grid, CellSize, float, 0.05, "Size, in metres");\n'
    'RTABMAP_PARAM_STR(Odom, Kind, "a b", "Kind");\n',
    "../corelib/src/Parameters.cpp": 'removedParameters_.insert(std::make_pair("Old/Size", std::make_pair(true, '
    "Parameters::kGridCellSize())));\n",
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
  const int depth_ = 5;
};
class Listener { };
class Rocks : public nav2_costmap_2d::Layer { };
}
""",
    "src/server.cpp": """
// declare_parameter("in_a_comment", 1);
const char CAMERA[] = "eye/image";
namespace my_layers {
Server::Server(const rclcpp::NodeOptions & options)
: Base("rock_server", options), listener_{nullptr} {
  /* declare_parameter("also_in_a_comment", 1); */
  declare_parameter("radius", radius_);
  const std::string separator = "a;b";
  declare_parameter("separator", separator);
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
  std::stringstream text;
  text << "rocks/" << frame_;
  pub_ = create_publisher<std_msgs::msg::Bool>("say \\" + " + frame_, depth_);
  pub_ = create_publisher<std_msgs::msg::Empty>(text.str().c_str(), 1);
  pub_ = create_publisher<std_msgs::msg::Empty>(known_later(1), 1);
  pub_ = create_publisher<std_msgs::msg::Char>("bare");
  declare_parameter("stamped", true);
  get_parameter("stamped", stamped_);
  if (stamped_ && callback) {
    cmd_ = create_publisher<geometry_msgs::msg::TwistStamped>("cmd", 1);
  }
  if (stamped_) pub_.reset(); else { pub_ = create_publisher<std_msgs::msg::Int8>("said", 1); }
  if (stamped_) {} else { cmd_ = create_publisher<geometry_msgs::msg::Twist>("cmd", 1); }
  camera_ = image_transport::create_camera_publisher(this, CAMERA, rclcpp::QoS{9}.get_rmw_qos_profile());
}
Base::Base(const std::string & name, const rclcpp::NodeOptions & options) : Node(name, options) {
  declare_parameter("count", 9);
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
    sources = checkout.parent / "sources.yaml"
    sources.write_text("layers: {from: owner/layers, supplemented: true, humble: HEAD}\n", encoding="utf-8")
    options = ["--distribution", "humble", "--sources", str(sources), "--output", str(checkout.parent)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["", str(checkout.parent), *options])
        assert main() == 0
    found: dict[str, Any] = json.loads((checkout.parent / "humble.json").read_text(encoding="utf-8"))
    return found


def test_packages_have_versions_executables_and_components(catalogue: dict[str, Any]) -> None:
    """Names in CMakeLists.txt are resolved, and main says which node a program is; sources have commits."""
    package = catalogue["packages"]["my_layers"]
    assert (package["version"], package["source"]) == ("2.1.0", "layers")
    assert len(catalogue["sources"]["layers"]["commit"]) == 40
    assert package["executables"] == {"my_listener": "my_layers::Listener", "my_server": "my_layers::Server"}
    assert package["components"] == {"Server": "my_layers::Server"}


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
        "separator": {"type": "string", "default": "a;b"},
        "stamped": {"type": "bool", "default": True},
        "use_sim_time": {"type": "bool", "default": False},
    }


def test_topics_have_types_and_qos(catalogue: dict[str, Any]) -> None:
    """A topic is a text, a sum, the value of a parameter, or what the maker of an object gives, perhaps conditional."""
    keys = ("kind", "name", "type", "reliability", "durability", "when")
    assert catalogue["classes"]["my_layers::Server"]["endpoints"] == [
        dict(zip(keys, values))
        for values in (
            ("publisher", "bare", "std_msgs/msg/Char", "reliable", "volatile"),
            ("publisher", "cmd", "geometry_msgs/msg/Twist", "reliable", "volatile", "not ($(stamped))"),
            ("publisher", "cmd", "geometry_msgs/msg/TwistStamped", "reliable", "volatile", "$(stamped)"),
            ("publisher", "eye/camera_info", "sensor_msgs/msg/CameraInfo", "reliable", "volatile"),
            ("publisher", "eye/image", "sensor_msgs/msg/Image", "reliable", "volatile"),
            ("publisher", "rocks/base_link", "std_msgs/msg/Empty", "reliable", "volatile"),
            ("publisher", "rocks/map", "nav_msgs/msg/OccupancyGrid", "reliable", "transient_local"),
            ("publisher", "said", "std_msgs/msg/Int8", "reliable", "volatile"),
            ("publisher", 'say " + base_link', "std_msgs/msg/Bool", "reliable", "volatile"),
            ("service", "~/clear", "std_srvs/srv/Empty"),
            ("subscription", "$(scan_topic)", "sensor_msgs/msg/LaserScan", "best_effort", "volatile"),
            ("subscription", "odom", "nav_msgs/msg/Odometry", "reliable", "volatile"),
        )
    ]


def test_core_parameters_of_rtabmap_are_texts(catalogue: dict[str, Any]) -> None:
    """The macros of RTAB-Map's library give the names and defaults; what it removed has its new name."""
    found = catalogue["sets"]["rtabmap"]
    texts = {"Grid/CellSize": "0.05", "Odom/Kind": "a b"}
    assert found["parameters"] == {name: {"type": "string", "default": text} for name, text in texts.items()}
    assert found["renamed"] == {"Old/Size": "Grid/CellSize"}


def test_plugins_have_parameters_under_their_names(catalogue: dict[str, Any]) -> None:
    """Parameters that begin with the plugin's name are its own; the others are the node's."""
    assert catalogue["plugins"]["my_layers/Rocks"]["base"] == "nav2_costmap_2d::Layer"
    facts = catalogue["classes"]["my_layers::Rocks"]
    own = {"enabled": {"type": "bool", "default": True}, "height": {"type": "double", "default": 0.3}}
    assert facts["parameters"] == own
    assert facts["of_node"] == {"of_the_node": {"type": "integer", "default": -1}}
