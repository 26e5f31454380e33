#include <roverlink/any.hpp>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

namespace roverlink
{

google::protobuf::Any packed(const google::protobuf::Message & message)
{
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream output(&stream);
    // Without it, protobuf writes map entries in random order, and equal messages would give different bytes.
    output.SetSerializationDeterministic(true);
    if (!message.SerializeToCodedStream(&output)) {
      throw ConversionError(std::string(message.GetDescriptor()->full_name()), "cannot be serialized");
    }
  }
  google::protobuf::Any payload;
  // The prefix that protobuf's own PackFrom writes (any.proto); Python writes the same one.
  payload.set_type_url("type.googleapis.com/" + std::string(message.GetDescriptor()->full_name()));
  payload.set_value(bytes);
  return payload;
}

void check_empty(const google::protobuf::Any & payload, const char * place)
{
  if (!payload.type_url().empty() || !payload.value().empty()) {
    throw ConversionError(
      place, "it holds " + std::string(payload.type_url()) + ", for which the ROS 2 message has no field");
  }
}

}  // namespace roverlink
