// Generated from mapping.yaml (row survey) and survey.proto; do not edit.
// Regenerate with: roverlink generate

#ifndef ROVER__HANDLERS__SURVEY_HPP_
#define ROVER__HANDLERS__SURVEY_HPP_

#include <utility>

#include <roverlink/handler.hpp>

#include <envelope.pb.h>
#include <survey.pb.h>
#include <rover/msg/survey.hpp>

namespace rover::handlers
{

/// survey (1): Survey to rover/Survey on the topic survey.
class SurveyHandler final : public roverlink::Handler<::Envelope>
{
public:
  using Payload = ::Survey;
  using Message = rover::msg::Survey;

  static constexpr roverlink::Route ROUTE = {
    1,
    "survey",
    "survey",
    "board_to_ros",
  };

  explicit SurveyHandler(roverlink::Publish<Message> publish)
  : publish_(std::move(publish)) {}

  const roverlink::Route & route() const override
  {
    return ROUTE;
  }

  /// Convert Survey to rover/Survey.
  ///
  /// Throws roverlink::ConversionError for a value that the message cannot hold.
  static Message to_ros(const Payload & payload);

  /// Convert rover/Survey to Survey.
  ///
  /// Throws roverlink::ConversionError for a value that the payload cannot hold.
  static Payload from_ros(const Message & message);

private:
  void publish(const ::Envelope & envelope, const roverlink::Stamp & received) const override;

  roverlink::Publish<Message> publish_;
};

}  // namespace rover::handlers

#endif  // ROVER__HANDLERS__SURVEY_HPP_
