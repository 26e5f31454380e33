// Generated from mapping.yaml (row survey) and survey.proto; do not edit.
// Regenerate with: roverlink generate

#include <rover/handlers/survey.hpp>

#include <rover/conversions/sample.hpp>
#include <rover/conversions/survey_content.hpp>
#include <roverlink/json.hpp>
#include <roverlink/values.hpp>
#include <roverlink/well_known.hpp>

namespace rover::handlers
{

void SurveyHandler::publish(const ::Envelope & envelope, const roverlink::Stamp &) const
{
  publish_(to_ros(envelope.survey()));
}

SurveyHandler::Message SurveyHandler::to_ros(const Payload & payload)
{
  rover::msg::Survey message;
  message.fahrenheit = payload.fahrenheit();
  message.spin = payload.spin();
  message.mode = roverlink::narrow<std::uint8_t>(payload.mode(), "Survey.mode");
  message.has_depth = payload.has_depth();
  message.depth = payload.depth();
  message.sample = SampleConversion::to_ros(payload.sample());
  for (const auto & item : payload.samples()) {
    message.samples.push_back(SampleConversion::to_ros(item));
  }
  for (const auto & item : payload.parts()) {
    message.parts.emplace_back().data = roverlink::octets(item);
  }
  for (const auto & item : payload.modes()) {
    message.modes.push_back(roverlink::narrow<std::uint8_t>(item, "Survey.modes"));
  }
  message.flags.assign(payload.flags().begin(), payload.flags().end());
  for (const auto & item : payload.names()) {
    message.names.push_back(roverlink::text(item, "Survey.names"));
  }
  message.started = roverlink::timestamp_to_ros(payload.started(), "Survey.started");
  message.has_calibrated = payload.has_calibrated();
  message.has_humidity = payload.has_humidity();
  message.humidity = payload.humidity().value();
  message.mask = roverlink::field_mask_to_ros(payload.mask(), "Survey.mask");
  if (payload.has_settings()) {
    message.settings = roverlink::json_struct_to_ros(payload.settings(), "Survey.settings");
  }
  for (const auto * item : roverlink::sorted(payload.colours())) {
    auto & entry = message.colours.emplace_back();
    entry.key = roverlink::text(item->first, "Survey.colours");
    entry.value.colour = roverlink::narrow<std::uint16_t>(item->second, "Survey.colours");
  }
  for (const auto * item : roverlink::sorted(payload.levels())) {
    auto & entry = message.levels.emplace_back();
    entry.key = item->first;
    entry.value = item->second.value();
  }
  message.content = SurveyContentConversion::to_ros(payload.content());
  message.pose_x = payload.pose().x();
  message.has_pose_note = payload.pose().has_note();
  message.pose_note = roverlink::text(payload.pose().note(), "Survey.pose_note");
  return message;
}

SurveyHandler::Payload SurveyHandler::from_ros(const Message & message)
{
  ::Survey payload;
  auto & pose_payload = *payload.mutable_pose();
  payload.set_fahrenheit(message.fahrenheit);
  payload.set_spin(message.spin);
  payload.set_mode(roverlink::Enumerator(message.mode, "Survey.mode"));
  if (message.has_depth) {
    payload.set_depth(message.depth);
  }
  *payload.mutable_sample() = SampleConversion::from_ros(message.sample);
  for (const auto & item : message.samples) {
    *payload.add_samples() = SampleConversion::from_ros(item);
  }
  for (const auto & item : message.parts) {
    payload.add_parts(roverlink::bytes(item.data));
  }
  for (const auto & item : message.modes) {
    payload.add_modes(roverlink::Enumerator(item, "Survey.modes"));
  }
  payload.mutable_flags()->Add(message.flags.begin(), message.flags.end());
  for (const auto & item : message.names) {
    payload.add_names(roverlink::text(item, "Survey.names"));
  }
  *payload.mutable_started() = roverlink::timestamp_from_ros(message.started, "Survey.started");
  if (message.has_calibrated) {
    payload.mutable_calibrated();
  }
  if (message.has_humidity) {
    payload.mutable_humidity()->set_value(message.humidity);
  }
  *payload.mutable_mask() = roverlink::field_mask_from_ros(message.mask, "Survey.mask");
  if (!message.settings.empty()) {
    *payload.mutable_settings() = roverlink::json_struct_from_ros(message.settings, "Survey.settings");
  }
  for (const auto & item : message.colours) {
    auto & value = roverlink::added(*payload.mutable_colours(), roverlink::text(item.key, "Survey.colours"), "Survey.colours");
    value = roverlink::Enumerator(item.value.colour, "Survey.colours");
  }
  for (const auto & item : message.levels) {
    auto & value = roverlink::added(*payload.mutable_levels(), item.key, "Survey.levels");
    value.set_value(item.value);
  }
  *payload.mutable_content() = SurveyContentConversion::from_ros(message.content);
  pose_payload.set_x(message.pose_x);
  if (message.has_pose_note) {
    pose_payload.set_note(roverlink::text(message.pose_note, "Survey.pose_note"));
  }
  return payload;
}

}  // namespace rover::handlers
