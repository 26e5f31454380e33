// Generated from mapping.yaml (row order) and survey.proto; do not edit.
// Regenerate with: roverlink generate

#ifndef ROVER__HANDLERS__ORDER_HPP_
#define ROVER__HANDLERS__ORDER_HPP_

#include <roverlink/handler.hpp>

#include <envelope.pb.h>
#include <survey.pb.h>
#include <rover/msg/order.hpp>

namespace rover::handlers
{

/// order (2): rover/Order on the topic order to Order.
class OrderHandler final
{
public:
  using Payload = ::Order;
  using Message = rover::msg::Order;

  static constexpr roverlink::Route ROUTE = {
    2,
    "order",
    "order",
    "ros_to_board",
    {"best_effort", "volatile", "keep_last", 1},
  };

  /// Convert rover/Order to Order in an envelope.
  ///
  /// Throws roverlink::ConversionError for a value that the payload cannot hold.
  static ::Envelope envelope(const Message & message);

  /// Convert Order to rover/Order.
  ///
  /// Throws roverlink::ConversionError for a value that the message cannot hold.
  static Message to_ros(const Payload & payload);

  /// Convert rover/Order to Order.
  ///
  /// Throws roverlink::ConversionError for a value that the payload cannot hold.
  static Payload from_ros(const Message & message);
};

}  // namespace rover::handlers

#endif  // ROVER__HANDLERS__ORDER_HPP_
