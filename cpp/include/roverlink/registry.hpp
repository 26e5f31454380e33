#ifndef ROVERLINK__REGISTRY_HPP_
#define ROVERLINK__REGISTRY_HPP_

#include <cstddef>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <roverlink/handler.hpp>

namespace roverlink
{

/// Topic at compile time: the generated handler class, the ROS 2 message type and the route.
///
/// A function with a parameter `auto topic` is compiled for each topic, and so knows the type of the message.
template<typename Class>
struct Topic
{
  using Handler = Class;
  using Message = typename Class::Message;

  const Route & route = Class::ROUTE;
};

/// List, at compile time, of generated handler classes. Each class belongs to one topic.
template<typename... Classes>
struct Table
{
  static constexpr std::size_t SIZE = sizeof...(Classes);

  /// Call `visit` with the Topic of each class, in the order of mapping.yaml.
  template<typename Visit>
  static void for_each([[maybe_unused]] Visit visit)
  {
    (visit(Topic<Classes>()), ...);
  }
};

/// Map from field numbers in the envelope to handlers.
///
/// `number` is the function `<oneof>_case` of the envelope's class, which returns the field number of the payload.
template<typename Envelope, auto number>
class Registry
{
public:
  /// Return a registry with a handler for each class in the Table `Inbound`.
  ///
  /// `advertise` is called with each Topic, and returns the Publish function of the topic.
  template<typename Inbound, typename Advertise>
  static Registry of(Advertise advertise)
  {
    Registry registry;
    Inbound::for_each([&](auto topic) { registry.add<typename decltype(topic)::Handler>(advertise(topic)); });
    return registry;
  }

  /// Add a handler of the generated class. Several handlers can take the same payload, each for another topic.
  template<typename Class>
  void add(Publish<typename Class::Message> publish)
  {
    handlers_[Class::ROUTE.number].push_back(std::make_unique<Class>(std::move(publish)));
  }

  /// Pass an envelope to every handler of the envelope's payload, and return the number of these handlers.
  ///
  /// Throws ConversionError that names row and field if the message of a handler cannot hold a value. Before this is
  /// thrown, all other handlers publish their messages.
  std::size_t dispatch(const Envelope & envelope, const Stamp & received = Stamp()) const
  {
    const auto found = handlers_.find(static_cast<int>(std::invoke(number, envelope)));
    if (found == handlers_.end()) {
      return 0;
    }
    // The first error is kept until every handler had its turn: one topic must not silence another one.
    std::exception_ptr refused;
    for (const auto & handler : found->second) {
      try {
        handler->handle(envelope, received);
      } catch (const ConversionError &) {
        refused = refused ? refused : std::current_exception();
      }
    }
    if (refused) {
      std::rethrow_exception(refused);
    }
    return found->second.size();
  }

private:
  std::map<int, std::vector<std::unique_ptr<Handler<Envelope>>>> handlers_;
};

}  // namespace roverlink

#endif  // ROVERLINK__REGISTRY_HPP_
