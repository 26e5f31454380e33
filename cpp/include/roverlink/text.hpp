#ifndef ROVERLINK__TEXT_HPP_
#define ROVERLINK__TEXT_HPP_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace roverlink
{

/// Return a text unchanged if both protobuf and ROS 2 can hold it. Otherwise throw ConversionError.
///
/// The text must be UTF-8, have no NUL character, and have at most `bound` bytes.
std::string text(
  std::string_view value, const char * field, std::size_t bound = std::numeric_limits<std::size_t>::max());

/// Convert the value of a `bytes` field to a sequence of uint8.
std::vector<std::uint8_t> octets(std::string_view value);

/// Convert a sequence or an array of uint8 to the value of a `bytes` field.
template<typename Octets>
std::string bytes(const Octets & value)
{
  return std::string(value.begin(), value.end());
}

}  // namespace roverlink

#endif  // ROVERLINK__TEXT_HPP_
