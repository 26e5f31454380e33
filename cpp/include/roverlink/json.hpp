#ifndef ROVERLINK__JSON_HPP_
#define ROVERLINK__JSON_HPP_

#include <google/protobuf/struct.pb.h>

#include <string>

namespace roverlink
{

// google.protobuf.Struct, Value and ListValue to and from a text of JSON.
//
// Texts are written here and not by protobuf, whose output has no order of keys and other digits in each version: the
// C++ and the Python bridge publish the same bytes, keys in order, and every double keeps its bits.
//
// Texts are read by protobuf. JSON that the Python bridge reads means the same here, except that up to version 21 objects
// in each other are read 33 deep (Python: 49), and that from version 22 on the integer -0 keeps its sign. Beyond that,
// protobuf takes texts that the Python bridge refuses: integers that no double holds exactly, which it rounds, and,
// depending on its version, text that is not quite JSON, such as [1,] and 'a' and {a: 1}.
//
// All functions throw ConversionError for what the other side cannot hold.

/// Write a Struct as a JSON object.
std::string json_struct_to_ros(const google::protobuf::Struct & payload, const char * field);

/// Read a JSON object.
google::protobuf::Struct json_struct_from_ros(const std::string & text, const char * field);

/// Write a Value as JSON. Throws ConversionError for a Value without a kind, and for NaN and infinity.
std::string json_value_to_ros(const google::protobuf::Value & payload, const char * field);

/// Read JSON of any kind.
google::protobuf::Value json_value_from_ros(const std::string & text, const char * field);

/// Write a ListValue as a JSON array.
std::string json_list_to_ros(const google::protobuf::ListValue & payload, const char * field);

/// Read a JSON array.
google::protobuf::ListValue json_list_from_ros(const std::string & text, const char * field);

}  // namespace roverlink

#endif  // ROVERLINK__JSON_HPP_
