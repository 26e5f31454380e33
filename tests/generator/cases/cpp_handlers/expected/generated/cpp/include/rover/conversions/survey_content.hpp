// Generated from mapping.yaml (Survey.content); do not edit.
// Regenerate with: roverlink generate

#ifndef ROVER__CONVERSIONS__SURVEY_CONTENT_HPP_
#define ROVER__CONVERSIONS__SURVEY_CONTENT_HPP_

#include <google/protobuf/any.pb.h>
#include <rover/msg/survey_content.hpp>

namespace rover::handlers
{

/// Converts between Survey.content and rover/SurveyContent.
struct SurveyContentConversion
{
  /// Convert Survey.content to rover/SurveyContent.
  ///
  /// Throws roverlink::ConversionError for a value that the message cannot hold.
  static rover::msg::SurveyContent to_ros(const ::google::protobuf::Any & payload);

  /// Convert rover/SurveyContent to Survey.content.
  ///
  /// Throws roverlink::ConversionError for a value that the payload cannot hold.
  static ::google::protobuf::Any from_ros(const rover::msg::SurveyContent & message);
};

}  // namespace rover::handlers

#endif  // ROVER__CONVERSIONS__SURVEY_CONTENT_HPP_
