#ifndef ROVERLINK__HANDLER_HPP_
#define ROVERLINK__HANDLER_HPP_

#include <cstddef>
#include <functional>

#include <roverlink/conversion_error.hpp>
#include <roverlink/stamp.hpp>

namespace roverlink
{

/// Quality of service of a topic. The texts are the names of ROS 2's policies.
struct Qos
{
  const char * reliability = "reliable";
  const char * durability = "volatile";
  const char * history = "keep_last";
  std::size_t depth = 10;
};

/// Route of messages: a row of mapping.yaml, or an extra topic of a row.
struct Route
{
  /// Field number in the envelope's oneof.
  int number;
  /// Field name in the envelope's oneof.
  const char * name;
  /// ROS 2 topic as mapping.yaml spells it.
  const char * topic;
  /// Direction, for example `hardware_to_ros` or `ros_to_basestation`.
  const char * direction;
  Qos qos = {};
};

/// Function that publishes a message on one topic.
template<typename Message>
using Publish = std::function<void(const Message &)>;

/// Base class of generated handlers. A handler converts the payload of one row from a peer, and publishes the message.
template<typename Envelope>
class Handler
{
public:
  virtual ~Handler() = default;

  virtual const Route & route() const = 0;

  /// Convert the payload of an envelope to a ROS 2 message, and publish the message.
  ///
  /// `received` is the time at which the envelope was received; it is used if the message has a header. Throws
  /// ConversionError that names row and field if the message cannot hold a value.
  void handle(const Envelope & envelope, const Stamp & received = Stamp()) const
  {
    try {
      publish(envelope, received);
    } catch (const ConversionError & error) {
      throw error.in_row(route().name);
    }
  }

private:
  virtual void publish(const Envelope & envelope, const Stamp & received) const = 0;
};

}  // namespace roverlink

#endif  // ROVERLINK__HANDLER_HPP_
