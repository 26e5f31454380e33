#ifndef ROVERLINK__ENUMS_HPP_
#define ROVERLINK__ENUMS_HPP_

#include <google/protobuf/generated_enum_reflection.h>

#include <cstdint>
#include <sstream>
#include <string>

#include <roverlink/conversion_error.hpp>
#include <roverlink/numbers.hpp>

namespace roverlink
{

/// Number of an enum value. If the number is assigned to a variable of an enum type, it is checked and converted.
class Enumerator
{
public:
  Enumerator(std::int64_t number, const char * field)
  : number_(number),
    field_(field)
  {
  }

  /// Throws ConversionError if the number does not fit int32, or if the enum is closed and does not declare the number.
  template<typename Enum>
  operator Enum() const
  {
    check(*google::protobuf::GetEnumDescriptor<Enum>());
    return static_cast<Enum>(number_);
  }

private:
  void check(const google::protobuf::EnumDescriptor & declared) const;

  std::int64_t number_;
  const char * field_;
};

/// Return the error for a number in a ROS 2 message that stands for no member of the oneof.
ConversionError no_member(Wide number, const char * field);

/// Return the error for a value that has no counterpart, because mapping.yaml does not list it for the field.
ConversionError no_counterpart(const char * field, const std::string & value);

template<typename Number>
ConversionError no_counterpart(const char * field, Number value)
{
  std::ostringstream shown;
  shown << +value;
  return ConversionError(field, shown.str() + " is not among the values that the table lists for it");
}

}  // namespace roverlink

#endif  // ROVERLINK__ENUMS_HPP_
