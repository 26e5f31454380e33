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
  /// Convert a payload. Throws roverlink::ConversionError for a value that the message cannot hold.
  static rover::msg::SurveyContent to_ros(const ::google::protobuf::Any & payload);

  /// Convert a message. Throws roverlink::ConversionError for a value that the payload cannot hold.
  static ::google::protobuf::Any from_ros(const rover::msg::SurveyContent & message);
};

}  // namespace rover::handlers

#endif  // ROVER__CONVERSIONS__SURVEY_CONTENT_HPP_
