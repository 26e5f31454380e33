// Generated from mapping.yaml (row survey) and survey.proto; do not edit.
// Regenerate with: roverlink generate

#include <rover/extra_topics/survey_survey_mode.hpp>

#include <roverlink/values.hpp>

namespace rover::handlers
{

namespace
{

/// Return the value of data for a number of mode.
std::string data_of(int number)
{
  switch (number) {
    case 0:  // IDLE
      return "idle";
    case 1:  // DRILLING
      return "drilling";
    default:
      throw roverlink::no_counterpart("mode", number);
  }
}

/// Return the number of mode for a value of data.
int mode_from_data(const std::string & value)
{
  if (value == "idle") {
    return 0;  // IDLE
  }
  if (value == "drilling") {
    return 1;  // DRILLING
  }
  throw roverlink::no_counterpart("data", value);
}

}  // namespace

void SurveySurveyModeFeed::publish(const ::Envelope & envelope, const roverlink::Stamp & received) const
{
  publish_(to_ros(envelope.survey(), received));
}

SurveySurveyModeFeed::Message SurveySurveyModeFeed::to_ros(const Payload & payload, const roverlink::Stamp &)
{
  std_msgs::msg::String message;
  message.data = data_of(payload.mode());
  return message;
}

SurveySurveyModeFeed::Payload SurveySurveyModeFeed::from_ros(const Message & message)
{
  ::Survey payload;
  payload.set_mode(roverlink::Enumerator(mode_from_data(message.data), "mode"));
  return payload;
}

}  // namespace rover::handlers
