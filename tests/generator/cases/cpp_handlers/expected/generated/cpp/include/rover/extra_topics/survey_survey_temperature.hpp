// Generated from mapping.yaml (row survey) and survey.proto; do not edit.
// Regenerate with: roverlink generate

#ifndef ROVER__EXTRA_TOPICS__SURVEY_SURVEY_TEMPERATURE_HPP_
#define ROVER__EXTRA_TOPICS__SURVEY_SURVEY_TEMPERATURE_HPP_

#include <utility>

#include <roverlink/handler.hpp>

#include <envelope.pb.h>
#include <survey.pb.h>
#include <sensor_msgs/msg/temperature.hpp>

namespace rover::handlers
{

/// survey (1): Survey to sensor_msgs/Temperature on the topic survey/temperature.
class SurveySurveyTemperatureFeed final : public roverlink::Handler<::Envelope>
{
public:
  using Payload = ::Survey;
  using Message = sensor_msgs::msg::Temperature;

  static constexpr roverlink::Route ROUTE = {
    1,
    "survey",
    "survey/temperature",
    "board_to_ros",
  };

  explicit SurveySurveyTemperatureFeed(roverlink::Publish<Message> publish)
  : publish_(std::move(publish)) {}

  const roverlink::Route & route() const override
  {
    return ROUTE;
  }

  /// Convert Survey to sensor_msgs/Temperature.
  ///
  /// Throws roverlink::ConversionError for a value that the message cannot hold.
  static Message to_ros(const Payload & payload, const roverlink::Stamp & received = {});

  /// Convert sensor_msgs/Temperature to Survey.
  ///
  /// Does not set spin, mode, depth, sample.image, samples, parts, modes, flags, names, started.seconds,
  /// started.nanos, humidity.value, mask.paths, settings.fields, colours, levels, content.type_url,
  /// content.value, pose.x, pose.note.
  /// Throws roverlink::ConversionError for a value that the payload cannot hold.
  static Payload from_ros(const Message & message);

private:
  void publish(const ::Envelope & envelope, const roverlink::Stamp & received) const override;

  roverlink::Publish<Message> publish_;
};

}  // namespace rover::handlers

#endif  // ROVER__EXTRA_TOPICS__SURVEY_SURVEY_TEMPERATURE_HPP_
