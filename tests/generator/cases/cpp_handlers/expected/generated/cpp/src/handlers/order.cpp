// Generated from mapping.yaml (row order) and survey.proto; do not edit.
// Regenerate with: roverlink generate

#include <rover/handlers/order.hpp>

#include <rover/conversions/empty.hpp>
#include <roverlink/values.hpp>
#include <roverlink/well_known.hpp>

namespace rover::handlers
{

::Envelope OrderHandler::envelope(const Message & message)
{
  ::Envelope envelope;
  *envelope.mutable_order() = from_ros(message);
  if (!envelope.IsInitialized()) {
    throw roverlink::ConversionError(ROUTE.name, "not set: " + envelope.InitializationErrorString());
  }
  return envelope;
}

OrderHandler::Message OrderHandler::to_ros(const Payload & payload)
{
  rover::msg::Order message;
  if (payload.has_drill_to()) {
    message.which_action = rover::msg::Order::ACTION_DRILL_TO;
  } else if (payload.has_wait_for()) {
    message.which_action = rover::msg::Order::ACTION_WAIT_FOR;
  } else if (payload.has_stop()) {
    message.which_action = rover::msg::Order::ACTION_STOP;
  }
  message.drill_to = payload.drill_to();
  message.wait_for = roverlink::duration_to_ros(payload.wait_for(), "Order.wait_for");
  message.stop = EmptyConversion::to_ros(payload.stop());
  return message;
}

OrderHandler::Payload OrderHandler::from_ros(const Message & message)
{
  ::Order payload;
  switch (message.which_action) {
    case 0:
      break;
    case rover::msg::Order::ACTION_DRILL_TO:
      payload.set_drill_to(message.drill_to);
      break;
    case rover::msg::Order::ACTION_WAIT_FOR:
      *payload.mutable_wait_for() = roverlink::duration_from_ros(message.wait_for, "Order.wait_for");
      break;
    case rover::msg::Order::ACTION_STOP:
      *payload.mutable_stop() = EmptyConversion::from_ros(message.stop);
      break;
    default:
      throw roverlink::no_member(message.which_action, "Order.which_action");
  }
  return payload;
}

}  // namespace rover::handlers
