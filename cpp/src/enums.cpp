#include <roverlink/enums.hpp>

#include <google/protobuf/descriptor.h>

#include <type_traits>

namespace roverlink
{

namespace
{

// is_closed() exists from protobuf 22 on. Before, the enums of proto2 were closed and all others were open.
template<typename Enum>
auto is_closed(const Enum & declared, int) -> decltype(declared.is_closed())
{
  return declared.is_closed();
}

template<typename Enum>
bool is_closed(const Enum & declared, long)  // a worse match for 0 than the function above
{
  using File = std::decay_t<decltype(*declared.file())>;
  return declared.file()->syntax() == File::SYNTAX_PROTO2;
}

}  // namespace

void Enumerator::check(const google::protobuf::EnumDescriptor & declared) const
{
  const int number = narrow<std::int32_t>(number_, field_);
  // A receiver keeps an undeclared number of a closed enum as an unknown field, and reads the field as absent
  // (protobuf.dev, "Enum Behavior"). Open enums carry any int32.
  if (is_closed(declared, 0) && declared.FindValueByNumber(number) == nullptr) {
    throw ConversionError(field_, std::to_string(number) + " is not a value of " + std::string(declared.full_name()));
  }
}

ConversionError no_member(Wide number, const char * field)
{
  return ConversionError(field, digits(number) + " is not the number of a member");
}

ConversionError no_counterpart(const char * field, const std::string & value)
{
  return ConversionError(field, '"' + value + "\" is not among the values that the table lists for it");
}

}  // namespace roverlink
