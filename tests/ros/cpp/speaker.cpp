// Does what the generated handlers do, for a program that compares: a question a line, an answer a line.
//
//   to TOPIC SEC NANOSEC PAYLOAD     the serialized ROS 2 message of a payload, by dispatching an envelope
//   from TOPIC MESSAGE               the payload of a serialized ROS 2 message
//   envelope TOPIC MESSAGE           the envelope that an outbound row makes of it
//
// Bytes are in hexadecimal, `-` for none. An answer is `is BYTES`, or `refused TEXT`, with the text as bytes, too.
// Messages are serialized by Fast CDR, along rosidl's introspection of the structs; the only thing that is taken from
// the generator is what is tested.

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <functional>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <rosidl_typesupport_introspection_cpp/field_types.hpp>
#include <rosidl_typesupport_introspection_cpp/message_introspection.hpp>
#include <rosidl_typesupport_introspection_cpp/message_type_support_decl.hpp>

#include REGISTRY

namespace speaker  // for messages have names of all kinds
{

namespace handlers = PACKAGE::handlers;
namespace introspection = rosidl_typesupport_introspection_cpp;
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;
using introspection::MessageMember;
using introspection::MessageMembers;

// --- ROS 2 messages ------------------------------------------------------------------------------------------------

template<typename Visit>
void visit_primitive(uint8_t type, Visit visit)
{
  switch (type) {
    case introspection::ROS_TYPE_FLOAT: return visit(float());
    case introspection::ROS_TYPE_DOUBLE: return visit(double());
    case introspection::ROS_TYPE_BOOLEAN: return visit(bool());
    case introspection::ROS_TYPE_CHAR:
    case introspection::ROS_TYPE_OCTET:
    case introspection::ROS_TYPE_UINT8: return visit(uint8_t());
    case introspection::ROS_TYPE_INT8: return visit(int8_t());
    case introspection::ROS_TYPE_UINT16: return visit(uint16_t());
    case introspection::ROS_TYPE_INT16: return visit(int16_t());
    case introspection::ROS_TYPE_UINT32: return visit(uint32_t());
    case introspection::ROS_TYPE_INT32: return visit(int32_t());
    case introspection::ROS_TYPE_UINT64: return visit(uint64_t());
    case introspection::ROS_TYPE_INT64: return visit(int64_t());
    case introspection::ROS_TYPE_STRING: return visit(std::string());
    default: throw std::runtime_error("a type that this program does not know");
  }
}

const MessageMembers & members_of(const MessageMember & member)
{
  return *static_cast<const MessageMembers *>(member.members_->data);
}

void write(const MessageMembers & members, const void * message, Cdr & cdr);
void read(const MessageMembers & members, void * message, Cdr & cdr);

void write_one(const MessageMember & member, const void * value, Cdr & cdr)
{
  if (member.type_id_ == introspection::ROS_TYPE_MESSAGE) {
    return write(members_of(member), value, cdr);
  }
  visit_primitive(member.type_id_, [&](auto zero) {cdr << *static_cast<const decltype(zero) *>(value);});
}

void read_one(const MessageMember & member, void * value, Cdr & cdr)
{
  if (member.type_id_ == introspection::ROS_TYPE_MESSAGE) {
    return read(members_of(member), value, cdr);
  }
  visit_primitive(member.type_id_, [&](auto zero) {cdr >> *static_cast<decltype(zero) *>(value);});
}

bool is_sequence(const MessageMember & member)
{
  return member.is_array_ && (member.array_size_ == 0 || member.is_upper_bound_);
}

void write(const MessageMembers & members, const void * message, Cdr & cdr)
{
  for (uint32_t index = 0; index < members.member_count_; ++index) {
    const auto & member = members.members_[index];
    const void * value = static_cast<const char *>(message) + member.offset_;
    if (!member.is_array_) {
      write_one(member, value, cdr);
      continue;
    }
    const size_t count = member.size_function(value);
    if (is_sequence(member)) {
      cdr << static_cast<uint32_t>(count);
    }
    for (size_t item = 0; item < count; ++item) {
      if (member.type_id_ == introspection::ROS_TYPE_BOOLEAN && is_sequence(member)) {
        cdr << static_cast<bool>((*static_cast<const std::vector<bool> *>(value))[item]);
      } else {
        write_one(member, member.get_const_function(value, item), cdr);
      }
    }
  }
}

void read(const MessageMembers & members, void * message, Cdr & cdr)
{
  for (uint32_t index = 0; index < members.member_count_; ++index) {
    const auto & member = members.members_[index];
    void * value = static_cast<char *>(message) + member.offset_;
    if (!member.is_array_) {
      read_one(member, value, cdr);
      continue;
    }
    uint32_t count = member.array_size_;
    if (is_sequence(member)) {
      cdr >> count;
      member.resize_function(value, count);
    }
    for (size_t item = 0; item < count; ++item) {
      if (member.type_id_ == introspection::ROS_TYPE_BOOLEAN && is_sequence(member)) {
        bool flag = false;
        cdr >> flag;
        (*static_cast<std::vector<bool> *>(value))[item] = flag;
      } else {
        read_one(member, member.get_function(value, item), cdr);
      }
    }
  }
}

template<typename Message>
const MessageMembers & members()
{
  return *static_cast<const MessageMembers *>(
    introspection::get_message_type_support_handle<Message>()->data);
}

template<typename Message>
std::string serialized(const Message & message)
{
  std::vector<char> zeros(1 << 18);  // for Fast CDR leaves what it aligns by as it is
  FastBuffer buffer(zeros.data(), zeros.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  write(members<Message>(), &message, cdr);
  return std::string(buffer.getBuffer(), cdr.getSerializedDataLength());
}

template<typename Message>
Message deserialized(std::string data)
{
  FastBuffer buffer(data.data(), data.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.read_encapsulation();
  Message message;
  read(members<Message>(), &message, cdr);
  return message;
}

// --- payloads ------------------------------------------------------------------------------------------------------

std::string serialized_payload(const google::protobuf::Message & payload)
{
  std::string bytes;
  google::protobuf::io::StringOutputStream stream(&bytes);
  {
    google::protobuf::io::CodedOutputStream output(&stream);
    output.SetSerializationDeterministic(true);
    payload.SerializePartialToCodedStream(&output);
  }
  return bytes;
}

// --- questions and answers -----------------------------------------------------------------------------------------

std::string unhex(const std::string & text)
{
  std::string bytes;
  for (size_t place = 0; text != "-" && place < text.size(); place += 2) {
    bytes += static_cast<char>(std::stoi(text.substr(place, 2), nullptr, 16));
  }
  return bytes;
}

std::string hex(const std::string & bytes)
{
  std::string text;
  for (const char byte : bytes) {
    constexpr char DIGITS[] = "0123456789abcdef";
    text += {DIGITS[static_cast<unsigned char>(byte) >> 4], DIGITS[byte & 15]};
  }
  return text.empty() ? "-" : text;
}

using Answer = std::function<std::string (const std::string & what, std::istream & question)>;

/// The answers of one topic; those of inbound ones go through the registry's dispatch, as a node's would.
template<typename Class>
std::string answer(const std::string & what, std::istream & question)
{
  using Message = typename Class::Message;
  roverlink::Stamp received;
  std::string data;
  if (what == "to") {
    question >> received.sec >> received.nanosec;
  }
  question >> data;
  if (what == "from") {
    return serialized_payload(Class::from_ros(deserialized<Message>(unhex(data))));
  }
  if constexpr (!std::is_base_of_v<roverlink::Handler<ENVELOPE>, Class>) {
    if (what == "envelope") {
      return serialized_payload(Class::envelope(deserialized<Message>(unhex(data))));
    }
    typename Class::Payload payload;
    if (!payload.ParsePartialFromString(unhex(data))) {
      throw std::runtime_error("no payload");
    }
    if constexpr (std::is_invocable_v<decltype(Class::to_ros), typename Class::Payload, roverlink::Stamp>) {
      return serialized(Class::to_ros(payload, received));
    } else {
      return serialized(Class::to_ros(payload));
    }
  } else {
    ENVELOPE envelope;
    if (!envelope.ParsePartialFromString(unhex(data))) {
      throw std::runtime_error("no envelope");
    }
    std::string published;
    handlers::Registry registry;
    registry.add<Class>([&](const Message & message) {published = serialized(message);});
    if (registry.dispatch(envelope, received) != 1) {
      throw std::runtime_error("nobody took it");
    }
    return published;
  }
}

void speak()
{
  std::map<std::string, Answer> answers;
  const auto add = [&](auto topic) {
      using Class = typename decltype(topic)::Handler;
      answers[topic.route.topic] = answer<Class>;
    };
  handlers::Inbound::for_each(add);
  handlers::Outbound::for_each(add);
  for (std::string line; std::getline(std::cin, line); ) {
    std::istringstream question(line);
    std::string what, topic;
    question >> what >> topic;
    try {
      const std::string said = hex(answers.at(topic)(what, question));
      std::cout << "is " << said << std::endl;
    } catch (const roverlink::ConversionError & error) {
      std::cout << "refused " << hex(error.what()) << std::endl;
    }
  }
}

}  // namespace speaker

int main()
{
  speaker::speak();
}
