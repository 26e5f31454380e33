// Generated from mapping.yaml; do not edit.
// Regenerate with: roverlink generate

#ifndef ROVER__REGISTRY_HPP_
#define ROVER__REGISTRY_HPP_

#include <roverlink/registry.hpp>

#include <rover/handlers/survey.hpp>
#include <rover/extra_topics/survey_survey_temperature.hpp>
#include <rover/extra_topics/survey_survey_spin.hpp>
#include <rover/extra_topics/survey_survey_mode.hpp>
#include <rover/handlers/order.hpp>
#include <rover/handlers/chain.hpp>
#include <rover/handlers/legacy.hpp>

namespace rover::handlers
{

/// The classes of the rows that peers send, in the order of the table.
using Inbound = roverlink::Table<
  SurveyHandler,
  SurveySurveyTemperatureFeed,
  SurveySurveySpinFeed,
  SurveySurveyModeFeed
>;

/// The classes of the rows that peers receive, in the order of the table.
using Outbound = roverlink::Table<
  OrderHandler,
  ChainHandler,
  LegacyHandler
>;

using Registry = roverlink::Registry<::Envelope, &::Envelope::payload_case>;

/// Make a registry with every inbound handler.
///
/// `advertise` takes the Topic of each and returns the function that publishes its messages:
///
///     [&](auto topic) {
///       using Message = typename decltype(topic)::Message;
///       return [](const Message & message) { /* ... */ };
///     }
template<typename Advertise>
Registry make_registry(Advertise advertise)
{
  return Registry::of<Inbound>(advertise);
}

}  // namespace rover::handlers

#endif  // ROVER__REGISTRY_HPP_
