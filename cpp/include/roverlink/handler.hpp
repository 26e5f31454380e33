#ifndef ROVERLINK__HANDLER_HPP_
#define ROVERLINK__HANDLER_HPP_

#include <cstddef>
#include <functional>

#include <roverlink/conversion_error.hpp>
#include <roverlink/stamp.hpp>

namespace roverlink
{

/// Quality of service of a topic, with the names of ROS 2.
struct Qos
{
  const char * reliability = "reliable";
  const char * durability = "volatile";
  const char * history = "keep_last";
  std::size_t depth = 10;
};

/// A row of mapping.yaml, or an extra topic of a row.
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

/// A function that publishes a message.
template<typename Message>
using Publish = std::function<void(const Message &)>;

/// Converts the payload of one inbound row and publishes the message. Generated classes derive from this one.
template<typename Envelope>
class Handler
{
public:
  virtual ~Handler() = default;

  virtual const Route & route() const = 0;

  /// Convert and publish the payload of an envelope. `received` is the time of reception, for messages with a header.
  ///
  /// Throws ConversionError, with row and field, for a value that the message cannot hold.
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
