// Generated from mapping.yaml (row survey) and survey.proto; do not edit.
// Regenerate with: roverlink generate

#ifndef ROVER__HANDLERS__SURVEY_HPP_
#define ROVER__HANDLERS__SURVEY_HPP_

#include <utility>

#include <rover/msg/survey.hpp>
#include <rover/runtime/handler.hpp>
#include <survey.pb.h>

namespace rover::handlers
{

/// survey (1): Survey to the topic survey.
class SurveyHandler final : public Handler
{
public:
  using Payload = ::Survey;
  using Message = rover::msg::Survey;

  static constexpr Route ROUTE{1, "survey", "survey", "board_to_ros"};

  explicit SurveyHandler(Publish<Message> publish)
  : publish_(std::move(publish)) {}

  const Route & route() const override
  {
    return ROUTE;
  }

  /// The message that says what the payload says. Throws ConversionError for what it cannot hold.
  static Message to_ros(const Payload & payload);

  /// The payload that says what the message says. Throws ConversionError for what it cannot hold.
  static Payload from_ros(const Message & message);

private:
  void publish(const ::Envelope & envelope, const Stamp & received) const override;

  Publish<Message> publish_;
};

}  // namespace rover::handlers

#endif  // ROVER__HANDLERS__SURVEY_HPP_
