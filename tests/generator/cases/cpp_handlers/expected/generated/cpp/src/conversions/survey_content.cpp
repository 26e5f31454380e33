// Generated from mapping.yaml (Survey.content); do not edit.
// Regenerate with: roverlink generate

#include <rover/conversions/survey_content.hpp>

#include <roverlink/any.hpp>
#include <roverlink/values.hpp>
#include <rover/conversions/sample.hpp>
#include <survey.pb.h>

namespace rover::handlers
{

rover::msg::SurveyContent SurveyContentConversion::to_ros(const ::google::protobuf::Any & payload)
{
  rover::msg::SurveyContent message;
  if (roverlink::holds<::Sample>(payload)) {
    message.which = rover::msg::SurveyContent::SAMPLE;
    message.sample = SampleConversion::to_ros(roverlink::unpacked<::Sample>(payload, "SurveyContent.sample"));
    return message;
  }
  roverlink::check_empty(payload, "SurveyContent");
  return message;
}

::google::protobuf::Any SurveyContentConversion::from_ros(const rover::msg::SurveyContent & message)
{
  switch (message.which) {
    case 0:
      return ::google::protobuf::Any();
    case rover::msg::SurveyContent::SAMPLE:
      return roverlink::packed(SampleConversion::from_ros(message.sample));
    default:
      throw roverlink::no_member(message.which, "SurveyContent.which");
  }
}

}  // namespace rover::handlers
