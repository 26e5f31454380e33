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

/// Check a text that both sides must be able to hold: UTF-8 without a NUL character, which a ROS string cannot hold.
///
/// `bound` is the largest number of bytes. Throws ConversionError for any other text.
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
