#include <roverlink/numbers.hpp>

#include <cmath>

namespace roverlink
{

std::string digits(Wide value)
{
  const bool negative = value < 0;
  std::string reversed;
  do {
    // Each digit is negated by itself, since the smallest number has no positive counterpart.
    const int digit = static_cast<int>(value % 10);
    reversed += static_cast<char>('0' + (negative ? -digit : digit));
    value /= 10;
  } while (value != 0);
  return (negative ? "-" : "") + std::string(reversed.rbegin(), reversed.rend());
}

Wide whole(double value, const char * field)
{
  // nearbyint rounds halves to even, the default rounding mode of IEEE 754.
  const double nearest = std::nearbyint(value);
  // False for NaN, too. 100 bits leave room in a Wide for the sums and products that follow.
  if (!(std::abs(nearest) < 0x1p100)) {
    throw ConversionError(field, std::to_string(value) + " is too large for an integer, or not a number");
  }
  return static_cast<Wide>(nearest);
}

float single(double value, const char * field)
{
  const float nearest = static_cast<float>(value);
  if (std::isinf(nearest) && !std::isinf(value)) {
    throw ConversionError(field, std::to_string(value) + " is too large for float32");
  }
  return nearest;
}

}  // namespace roverlink
