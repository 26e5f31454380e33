// Generated from mapping.yaml (row survey) and survey.proto; do not edit.
// Regenerate with: roverlink generate

#ifndef ROVER__FEEDS__SURVEY_SURVEY_TEMPERATURE_HPP_
#define ROVER__FEEDS__SURVEY_SURVEY_TEMPERATURE_HPP_

#include <utility>

#include <rover/runtime/handler.hpp>
#include <sensor_msgs/msg/temperature.hpp>
#include <survey.pb.h>

namespace rover::handlers
{

/// survey (1): Survey as sensor_msgs/Temperature to the topic survey/temperature.
class SurveySurveyTemperatureFeed final : public Handler
{
public:
  using Payload = ::Survey;
  using Message = sensor_msgs::msg::Temperature;

  static constexpr Route ROUTE{1, "survey", "survey/temperature", "board_to_ros"};

  explicit SurveySurveyTemperatureFeed(Publish<Message> publish)
  : publish_(std::move(publish)) {}

  const Route & route() const override
  {
    return ROUTE;
  }

  /// The message that says what the payload says. Throws ConversionError for what it cannot hold.
  static Message to_ros(const Payload & payload, const Stamp & received = Stamp());

  /// The payload that says what the message says. It says nothing of spin, mode, depth, sample.image, samples, parts,
  /// modes, flags, names, started.seconds, started.nanos, humidity.value, mask.paths, settings.fields, colours, levels,
  /// content.type_url, content.value, pose.x, pose.note. Throws ConversionError for what it cannot hold.
  static Payload from_ros(const Message & message);

private:
  void publish(const ::Envelope & envelope, const Stamp & received) const override;

  Publish<Message> publish_;
};

}  // namespace rover::handlers

#endif  // ROVER__FEEDS__SURVEY_SURVEY_TEMPERATURE_HPP_
