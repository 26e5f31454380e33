// Generated from mapping.yaml; do not edit.
// Regenerate with: roverlink generate

#ifndef ROVER__REGISTRY_HPP_
#define ROVER__REGISTRY_HPP_

#include <rover/feeds/survey_survey_mode.hpp>
#include <rover/feeds/survey_survey_spin.hpp>
#include <rover/feeds/survey_survey_temperature.hpp>
#include <rover/handlers/chain.hpp>
#include <rover/handlers/legacy.hpp>
#include <rover/handlers/order.hpp>
#include <rover/handlers/survey.hpp>
#include <rover/runtime/registry.hpp>

namespace rover::handlers
{

/// What comes from the peers, in the order of the table.
using Inbound = Table<
  SurveyHandler,
  SurveySurveyTemperatureFeed,
  SurveySurveySpinFeed,
  SurveySurveyModeFeed>;

/// What goes to the peers, in the order of the table.
using Outbound = Table<
  OrderHandler,
  ChainHandler,
  LegacyHandler>;

/// A registry with every inbound handler.
///
/// `advertise` is called with the Topic of each, and gives the function that publishes its messages:
///
///     [&](auto topic) {
///       using Message = typename decltype(topic)::Message;
///       return [](const Message & message) { /* ... */ };
///     }
template<typename Advertise>
Registry make_registry(Advertise advertise)
{
  Registry registry;
  Inbound::for_each(
    [&](auto topic) {
      registry.add<typename decltype(topic)::Handler>(advertise(topic));
    });
  return registry;
}

}  // namespace rover::handlers

#endif  // ROVER__REGISTRY_HPP_
