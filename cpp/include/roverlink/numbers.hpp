#ifndef ROVERLINK__NUMBERS_HPP_
#define ROVERLINK__NUMBERS_HPP_

#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>

#include <roverlink/conversion_error.hpp>

namespace roverlink
{

constexpr double PI = 3.141592653589793;

/// An integer that holds every value of every integer field, and the products and sums that scaling makes of them.
__extension__ typedef __int128 Wide;

/// Convert a number, an enum value or a bool to a Wide.
template<typename Number>
constexpr Wide wide(Number value)
{
  return static_cast<Wide>(value);
}

/// Write a Wide in decimal digits.
std::string digits(Wide value);

/// Convert an integer to a smaller type. Throws ConversionError if it does not fit.
template<typename To, typename From>
To narrow(From value, const char * field)
{
  // Compared as Wide: between a signed and an unsigned type, C++ would convert the negative number to a large one.
  const Wide number = wide(value);
  if (number < wide(std::numeric_limits<To>::min()) || number > wide(std::numeric_limits<To>::max())) {
    const std::string kind = std::is_signed_v<To> ? " does not fit int" : " does not fit uint";
    throw ConversionError(field, digits(number) + kind + std::to_string(8 * sizeof(To)));
  }
  return static_cast<To>(number);
}

/// Round to the nearest integer; a half is rounded to the even integer, as Python's round() does.
///
/// Throws ConversionError for NaN, infinity and numbers from 2^100 on.
Wide whole(double value, const char * field);

/// Round to the nearest integer of a type. Throws ConversionError if it does not fit.
template<typename To>
To rounded(double value, const char * field)
{
  return narrow<To>(whole(value, field), field);
}

/// Round to a float of 32 bits. Throws ConversionError for a finite number that would become infinite.
float single(double value, const char * field);

/// Divide and round down. `divisor` is positive.
constexpr Wide floored(Wide value, Wide divisor)
{
  // Division in C++ rounds towards zero, so a negative value with a remainder is one too high.
  return value / divisor - (value % divisor < 0 ? 1 : 0);
}

}  // namespace roverlink

#endif  // ROVERLINK__NUMBERS_HPP_
