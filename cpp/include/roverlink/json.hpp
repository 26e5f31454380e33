#ifndef ROVERLINK__JSON_HPP_
#define ROVERLINK__JSON_HPP_

#include <google/protobuf/struct.pb.h>

#include <string>

namespace roverlink
{

// Conversion of google.protobuf.Struct, Value and ListValue to and from JSON text (RFC 8259).
//
// JSON is written here and not by protobuf, whose output has no fixed order of keys, and whose digits differ between
// versions. The C++ and the Python bridge publish the same bytes: keys are sorted, and every double keeps its bits.
//
// JSON is read by protobuf. Text that the Python bridge accepts means the same here, with two exceptions: up to version
// 21 objects can be nested only 33 deep (Python: 49), and from version 22 on the integer -0 keeps its sign. Besides,
// protobuf accepts text that the Python bridge refuses: integers that no double holds exactly, which it rounds, and,
// depending on its version, text that is not quite JSON, such as [1,] and 'a' and {a: 1}.
//
// All functions throw ConversionError for a value that the type of the result cannot hold.

/// Return a Struct as the text of a JSON object.
std::string json_struct_to_ros(const google::protobuf::Struct & payload, const char * field);

/// Parse the text of a JSON object to a Struct.
google::protobuf::Struct json_struct_from_ros(const std::string & text, const char * field);

/// Return a Value as JSON text. Throws ConversionError for NaN, for infinity, and for a Value whose oneof is not set.
std::string json_value_to_ros(const google::protobuf::Value & payload, const char * field);

/// Parse the text of any JSON value to a Value.
google::protobuf::Value json_value_from_ros(const std::string & text, const char * field);

/// Return a ListValue as the text of a JSON array.
std::string json_list_to_ros(const google::protobuf::ListValue & payload, const char * field);

/// Parse the text of a JSON array to a ListValue.
google::protobuf::ListValue json_list_from_ros(const std::string & text, const char * field);

}  // namespace roverlink

#endif  // ROVERLINK__JSON_HPP_
