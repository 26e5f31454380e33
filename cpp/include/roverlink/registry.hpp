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

/// A topic, for code that is compiled once for each of them.
template<typename Class>
struct Topic
{
  using Handler = Class;
  using Message = typename Class::Message;

  const Route & route = Class::ROUTE;
};

/// A list of generated classes.
template<typename... Classes>
struct Table
{
  static constexpr std::size_t SIZE = sizeof...(Classes);

  /// Call a function with the Topic of each class, in the order of mapping.yaml.
  template<typename Visit>
  static void for_each([[maybe_unused]] Visit visit)
  {
    (visit(Topic<Classes>()), ...);
  }
};

/// Handlers by the field number of their payload. `number` is the envelope's function `<oneof>_case`.
template<typename Envelope, auto number>
class Registry
{
public:
  /// Make a registry with every handler of a Table. `advertise` takes a Topic and returns its Publish function.
  template<typename Inbound, typename Advertise>
  static Registry of(Advertise advertise)
  {
    Registry registry;
    Inbound::for_each([&](auto topic) { registry.add<typename decltype(topic)::Handler>(advertise(topic)); });
    return registry;
  }

  /// Add a handler. Several handlers can take the same payload, one for each of its topics.
  template<typename Class>
  void add(Publish<typename Class::Message> publish)
  {
    handlers_[Class::ROUTE.number].push_back(std::make_unique<Class>(std::move(publish)));
  }

  /// Pass an envelope to every handler of its payload and return how many there are.
  ///
  /// Throws ConversionError, with row and field, for a value that a message cannot hold. The other topics of the payload
  /// are published before that.
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
