#include <roverlink/json.hpp>

#include <google/protobuf/util/json_util.h>

#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <roverlink/containers.hpp>
#include <roverlink/conversion_error.hpp>
#include <roverlink/text.hpp>

namespace roverlink
{

namespace
{

/// Writes JSON as Python's json module does.
class Writer
{
public:
  explicit Writer(const char * field)
  : field_(field)
  {
  }

  void write(const google::protobuf::Struct & payload)
  {
    const char * between = "{";
    for (const auto * entry : sorted(payload.fields())) {
      made += between;
      write_text(std::string(entry->first));
      made += ": ";
      write(entry->second);
      between = ", ";
    }
    made += payload.fields().empty() ? "{}" : "}";
  }

  void write(const google::protobuf::ListValue & payload)
  {
    const char * between = "[";
    for (const auto & value : payload.values()) {
      made += between;
      write(value);
      between = ", ";
    }
    made += payload.values().empty() ? "[]" : "]";
  }

  void write(const google::protobuf::Value & payload)
  {
    switch (payload.kind_case()) {
      case google::protobuf::Value::kNullValue:
        made += "null";
        break;
      case google::protobuf::Value::kNumberValue:
        write_number(payload.number_value());
        break;
      case google::protobuf::Value::kStringValue:
        write_text(std::string(payload.string_value()));
        break;
      case google::protobuf::Value::kBoolValue:
        made += payload.bool_value() ? "true" : "false";
        break;
      case google::protobuf::Value::kStructValue:
        write(payload.struct_value());
        break;
      case google::protobuf::Value::kListValue:
        write(payload.list_value());
        break;
      default:
        throw ConversionError(field_, "cannot be JSON: a google.protobuf.Value has no kind");
    }
  }

  std::string made;

private:
  void write_text(const std::string & text)
  {
    constexpr std::string_view SPECIAL = "\"\\\b\f\n\r\t";
    constexpr std::string_view NAMES = "\"\\bfnrt";
    constexpr std::string_view HEXADECIMAL = "0123456789abcdef";
    made += '"';
    for (const char character : text) {
      const auto code = static_cast<unsigned char>(character);
      if (const auto place = SPECIAL.find(character); place != std::string_view::npos) {
        made += {'\\', NAMES[place]};
      } else if (code < 0x20) {
        // RFC 8259, section 7: control characters have to be escaped. Everything else stays UTF-8, as with Python's
        // ensure_ascii=False.
        made += {'\\', 'u', '0', '0', HEXADECIMAL[code >> 4], HEXADECIMAL[code & 15]};
      } else {
        made += character;
      }
    }
    made += '"';
  }

  /// Write the shortest digits that give the same double: from 1e-4 to 1e16 like 0.001, outside like 1e-05 (as Python).
  void write_number(double number)
  {
    if (!std::isfinite(number)) {
      // RFC 8259, section 6: JSON has no numbers for NaN and infinity.
      throw ConversionError(field_, "cannot be JSON: it has no NaN and no infinity");
    }
    char digits[64];
    // Without a precision, to_chars gives the shortest digits that are read back as the same double, as Python's repr
    // does.
    const auto scientific = std::to_chars(digits, digits + sizeof digits, number, std::chars_format::scientific);
    const std::string shortest(digits, scientific.ptr);
    const int exponent = std::stoi(shortest.substr(shortest.find('e') + 1));
    if (exponent < -4 || exponent >= 16) {
      made += shortest;
      return;
    }
    const auto fixed = std::to_chars(digits, digits + sizeof digits, number, std::chars_format::fixed);
    const std::string decimal(digits, fixed.ptr);
    made += decimal + (decimal.find('.') == std::string::npos ? ".0" : "");
  }

  const char * field_;
};

template<typename Payload>
std::string written(const Payload & payload, const char * field)
{
  Writer writer(field);
  writer.write(payload);
  return text(writer.made, field);
}

}  // namespace

std::string json_struct_to_ros(const google::protobuf::Struct & payload, const char * field)
{
  return written(payload, field);
}

google::protobuf::Struct json_struct_from_ros(const std::string & text, const char * field)
{
  google::protobuf::Value value = json_value_from_ros(text, field);
  if (!value.has_struct_value()) {
    throw ConversionError(field, "is JSON, but not an object");
  }
  return std::move(*value.mutable_struct_value());
}

std::string json_value_to_ros(const google::protobuf::Value & payload, const char * field)
{
  return written(payload, field);
}

google::protobuf::Value json_value_from_ros(const std::string & json, const char * field)
{
  google::protobuf::Value value;
  const auto status = google::protobuf::util::JsonStringToMessage(text(json, field), &value);
  if (!status.ok()) {
    throw ConversionError(field, "is not JSON that protobuf can hold: " + status.ToString());
  }
  return value;
}

std::string json_list_to_ros(const google::protobuf::ListValue & payload, const char * field)
{
  return written(payload, field);
}

google::protobuf::ListValue json_list_from_ros(const std::string & text, const char * field)
{
  google::protobuf::Value value = json_value_from_ros(text, field);
  if (!value.has_list_value()) {
    throw ConversionError(field, "is JSON, but not an array");
  }
  return std::move(*value.mutable_list_value());
}

}  // namespace roverlink
