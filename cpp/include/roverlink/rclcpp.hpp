#ifndef ROVERLINK__RCLCPP_HPP_
#define ROVERLINK__RCLCPP_HPP_

// This header needs rclcpp, to which the library is not linked. Include it only in programs that are ROS 2 nodes.

#include <memory>
#include <string>
#include <vector>

#include <rclcpp/rclcpp.hpp>

#include <roverlink/registry.hpp>

namespace roverlink
{

/// Convert a quality of service of this library to one of rclcpp.
inline rclcpp::QoS rclcpp_qos(const Qos & qos)
{
  rclcpp::QoS made{rclcpp::KeepLast(qos.depth)};
  if (qos.history == std::string("keep_all")) {
    made.keep_all();
  }
  if (qos.reliability == std::string("best_effort")) {
    made.best_effort();
  }
  if (qos.durability == std::string("transient_local")) {
    made.transient_local();
  }
  return made;
}

/// Return a registry with a handler for each class in `Inbound`; each handler publishes on its own topic of the node.
template<typename Registry, typename Inbound>
Registry advertise_all(rclcpp::Node & node)
{
  return Registry::template of<Inbound>([&](auto topic) {
    using Message = typename decltype(topic)::Message;
    auto publisher = node.create_publisher<Message>(topic.route.topic, rclcpp_qos(topic.route.qos));
    return [publisher](const Message & message) { publisher->publish(message); };
  });
}

/// Subscribe to the topics of all classes in `Outbound`. The subscriptions end when the returned list is destroyed.
///
/// For each message, `send` is called with the Route and the envelope. If the payload cannot hold a value of the
/// message, `send` is not called, and the node logs a warning.
template<typename Outbound, typename Send>
std::vector<rclcpp::SubscriptionBase::SharedPtr> subscribe_all(rclcpp::Node & node, Send send)
{
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions;
  Outbound::for_each([&](auto topic) {
    using Class = typename decltype(topic)::Handler;
    using Message = typename decltype(topic)::Message;
    const auto take = [send, logger = node.get_logger()](typename Message::ConstSharedPtr message) {
      try {
        send(Class::ROUTE, Class::envelope(*message));
      } catch (const ConversionError & error) {
        RCLCPP_WARN(logger, "%s: %s", Class::ROUTE.name, error.what());
      }
    };
    subscriptions.push_back(node.create_subscription<Message>(topic.route.topic, rclcpp_qos(topic.route.qos), take));
  });
  return subscriptions;
}

}  // namespace roverlink

#endif  // ROVERLINK__RCLCPP_HPP_
