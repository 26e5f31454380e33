#include <roverlink/text.hpp>

#include <roverlink/conversion_error.hpp>

namespace roverlink
{

namespace
{

/// Return the number of bytes of a text's first character; 0 if it is not UTF-8 (RFC 3629, section 4).
std::size_t character_size(std::string_view text)
{
  const auto byte = [&](std::size_t index) {
    return index < text.size() ? static_cast<unsigned char>(text[index]) : 0U;
  };
  const auto follows = [&](std::size_t index, unsigned low = 0x80, unsigned high = 0xBF) {
    return byte(index) >= low && byte(index) <= high;
  };
  const unsigned first = byte(0);
  if (first < 0x80) {
    return 1;
  }
  if (first >= 0xC2 && first <= 0xDF) {
    return follows(1) ? 2 : 0;
  }
  if (first >= 0xE0 && first <= 0xEF) {  // neither overlong nor half of a surrogate pair
    const bool valid = follows(1, first == 0xE0 ? 0xA0 : 0x80, first == 0xED ? 0x9F : 0xBF);
    return valid && follows(2) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {  // neither overlong nor beyond U+10FFFF
    const bool valid = follows(1, first == 0xF0 ? 0x90 : 0x80, first == 0xF4 ? 0x8F : 0xBF);
    return valid && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

}  // namespace

std::string text(std::string_view value, const char * field, std::size_t bound)
{
  if (value.size() > bound) {
    throw ConversionError(field, "has more than " + std::to_string(bound) + " bytes");
  }
  for (std::size_t place = 0; place < value.size();) {
    const std::size_t size = character_size(value.substr(place));
    if (size == 0) {
      throw ConversionError(field, "is not UTF-8");
    }
    if (value[place] == '\0') {
      throw ConversionError(field, "a ROS string cannot hold a NUL character");
    }
    place += size;
  }
  return std::string(value);
}

std::vector<std::uint8_t> octets(std::string_view value)
{
  return std::vector<std::uint8_t>(value.begin(), value.end());
}

}  // namespace roverlink
