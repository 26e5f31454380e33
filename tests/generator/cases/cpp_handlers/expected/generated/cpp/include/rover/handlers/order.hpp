// Generated from mapping.yaml (row order) and survey.proto; do not edit.
// Regenerate with: roverlink generate

#ifndef ROVER__HANDLERS__ORDER_HPP_
#define ROVER__HANDLERS__ORDER_HPP_

#include <rover/msg/order.hpp>
#include <rover/runtime/handler.hpp>
#include <survey.pb.h>

namespace rover::handlers
{

/// order (2): Order from the topic order.
class OrderHandler final
{
public:
  using Payload = ::Order;
  using Message = rover::msg::Order;

  static constexpr Route ROUTE{2, "order", "order", "ros_to_board", {"best_effort", "volatile", "keep_last", 1}};

  /// The envelope that says what the message says. Throws ConversionError for what it cannot hold.
  static ::Envelope envelope(const Message & message);

  /// The message that says what the payload says. Throws ConversionError for what it cannot hold.
  static Message to_ros(const Payload & payload);

  /// The payload that says what the message says. Throws ConversionError for what it cannot hold.
  static Payload from_ros(const Message & message);
};

}  // namespace rover::handlers

#endif  // ROVER__HANDLERS__ORDER_HPP_
