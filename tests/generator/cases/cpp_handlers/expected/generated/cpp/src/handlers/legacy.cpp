// Generated from mapping.yaml (row legacy) and legacy.proto; do not edit.
// Regenerate with: roverlink generate

#include <rover/handlers/legacy.hpp>

#include <rover/conversions/legacy_part.hpp>
#include <roverlink/values.hpp>

namespace rover::handlers
{

::Envelope LegacyHandler::envelope(const Message & message)
{
  ::Envelope envelope;
  *envelope.mutable_legacy() = from_ros(message);
  if (!envelope.IsInitialized()) {
    throw roverlink::ConversionError(ROUTE.name, "not set: " + envelope.InitializationErrorString());
  }
  return envelope;
}

LegacyHandler::Message LegacyHandler::to_ros(const Payload & payload)
{
  rover::msg::Legacy message;
  message.id = payload.id();
  message.has_level = payload.has_level();
  message.level = roverlink::narrow<std::uint8_t>(payload.level(), "Legacy.level");
  for (const auto & item : payload.levels()) {
    message.levels.push_back(roverlink::narrow<std::uint8_t>(item, "Legacy.levels"));
  }
  for (const auto & item : payload.part()) {
    message.part.push_back(LegacyPartConversion::to_ros(item));
  }
  return message;
}

LegacyHandler::Payload LegacyHandler::from_ros(const Message & message)
{
  ::Legacy payload;
  payload.set_id(message.id);
  if (message.has_level) {
    payload.set_level(roverlink::Enumerator(message.level, "Legacy.level"));
  }
  for (const auto & item : message.levels) {
    payload.add_levels(roverlink::Enumerator(item, "Legacy.levels"));
  }
  for (const auto & item : message.part) {
    *payload.add_part() = LegacyPartConversion::from_ros(item);
  }
  return payload;
}

}  // namespace rover::handlers
