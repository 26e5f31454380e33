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

/// Integer type for scaling integer fields. It holds every value of a field, and all products and sums of the scaling.
__extension__ typedef __int128 Wide;

/// Convert a number, an enum value or a bool to a Wide.
template<typename Number>
constexpr Wide wide(Number value)
{
  return static_cast<Wide>(value);
}

/// Return a Wide as a text of decimal digits.
std::string digits(Wide value);

/// Convert an integer to a smaller type. Throws ConversionError if the integer does not fit the type.
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

/// Round a number to the nearest integer. A number halfway between two is rounded to the even one, as in Python.
///
/// Throws ConversionError for NaN, infinity, and numbers whose absolute value is 2^100 or more.
Wide whole(double value, const char * field);

/// Round a number to the nearest integer, as a type. Throws ConversionError if the integer does not fit the type.
template<typename To>
To rounded(double value, const char * field)
{
  return narrow<To>(whole(value, field), field);
}

/// Round a double to a float of 32 bits. Throws ConversionError if a finite number would become infinite.
float single(double value, const char * field);

/// Return the quotient of two integers, rounded down. `divisor` must be positive.
constexpr Wide floored(Wide value, Wide divisor)
{
  // Division in C++ rounds towards zero, so a negative value with a remainder is one too high.
  return value / divisor - (value % divisor < 0 ? 1 : 0);
}

}  // namespace roverlink

#endif  // ROVERLINK__NUMBERS_HPP_
