// Generated from mapping.yaml (Survey.content); do not edit.
// Regenerate with: roverlink generate

#ifndef ROVER__CONVERSIONS__SURVEY_CONTENT_HPP_
#define ROVER__CONVERSIONS__SURVEY_CONTENT_HPP_

#include <google/protobuf/any.pb.h>
#include <rover/msg/survey_content.hpp>

namespace rover::handlers
{

/// Survey.content to and from rover/msg/SurveyContent.
struct SurveyContentConversion
{
  /// The message that says what the payload says. Throws ConversionError for what it cannot hold.
  static rover::msg::SurveyContent to_ros(const ::google::protobuf::Any & payload);

  /// The payload that says what the message says. Throws ConversionError for what it cannot hold.
  static ::google::protobuf::Any from_ros(const rover::msg::SurveyContent & message);
};

}  // namespace rover::handlers

#endif  // ROVER__CONVERSIONS__SURVEY_CONTENT_HPP_
