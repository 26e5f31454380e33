#ifndef ROVERLINK__ANY_HPP_
#define ROVERLINK__ANY_HPP_

#include <google/protobuf/any.pb.h>
#include <google/protobuf/message.h>

#include <string>

#include <roverlink/conversion_error.hpp>

namespace roverlink
{

/// Return true if the type URL of an Any names the message type of the template argument.
template<typename Payload>
bool holds(const google::protobuf::Any & payload)
{
  const std::string url(payload.type_url());
  // As in protobuf's own Any::Is, only the name after the last slash counts.
  const auto slash = url.rfind('/');
  return slash != std::string::npos && url.substr(slash + 1) == Payload::descriptor()->full_name();
}

/// Parse the message in an Any. Throws ConversionError if the bytes in the Any are not a message of the type Payload.
///
/// `place` is the path of the Any's field, for the error.
template<typename Payload>
Payload unpacked(const google::protobuf::Any & payload, const char * place)
{
  Payload held;
  if (!held.ParseFromString(payload.value())) {
    throw ConversionError(place, "its bytes are not a " + std::string(Payload::descriptor()->full_name()));
  }
  return held;
}

/// Return an Any that holds a message. Equal messages give equal bytes.
google::protobuf::Any packed(const google::protobuf::Message & message);

/// Throw ConversionError if an Any holds a message, because the ROS 2 message has no field for it.
void check_empty(const google::protobuf::Any & payload, const char * place);

}  // namespace roverlink

#endif  // ROVERLINK__ANY_HPP_
