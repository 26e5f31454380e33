// Generated from mapping.yaml (row survey) and survey.proto; do not edit.
// Regenerate with: roverlink generate

#include <rover/extra_topics/survey_survey_temperature.hpp>

#include <roverlink/values.hpp>

namespace rover::handlers
{

void SurveySurveyTemperatureFeed::publish(const ::Envelope & envelope, const roverlink::Stamp & received) const
{
  publish_(to_ros(envelope.survey(), received));
}

SurveySurveyTemperatureFeed::Message SurveySurveyTemperatureFeed::to_ros(const Payload & payload, const roverlink::Stamp & received)
{
  sensor_msgs::msg::Temperature message;
  message.header.stamp = received;
  message.header.frame_id = "probe";
  message.temperature = (payload.fahrenheit() - 32.0) / 1.8;
  message.variance = 0.25;
  return message;
}

SurveySurveyTemperatureFeed::Payload SurveySurveyTemperatureFeed::from_ros(const Message & message)
{
  ::Survey payload;
  payload.set_fahrenheit(roverlink::single(message.temperature * 1.8 + 32.0, "fahrenheit"));
  return payload;
}

}  // namespace rover::handlers
