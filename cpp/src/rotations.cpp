#include <roverlink/rotations.hpp>

#include <cmath>

#include <roverlink/numbers.hpp>

namespace roverlink
{

namespace
{

/// Sine of the pitch from which roll and yaw cannot be told apart in double precision.
constexpr double STRAIGHT = 1 - 1e-15;

}  // namespace

Quaternion quaternion(const Angles & angles, const char * field)
{
  if (std::isinf(angles.roll) || std::isinf(angles.pitch) || std::isinf(angles.yaw)) {
    throw ConversionError(field, "an angle cannot be infinite");
  }
  const double sin_roll = std::sin(angles.roll * 0.5);
  const double cos_roll = std::cos(angles.roll * 0.5);
  const double sin_pitch = std::sin(angles.pitch * 0.5);
  const double cos_pitch = std::cos(angles.pitch * 0.5);
  const double sin_yaw = std::sin(angles.yaw * 0.5);
  const double cos_yaw = std::cos(angles.yaw * 0.5);
  const double both_cos = cos_roll * cos_pitch;
  const double both_sin = sin_roll * sin_pitch;
  const double rolled = sin_roll * cos_pitch;
  const double pitched = cos_roll * sin_pitch;
  return Quaternion(
    rolled * cos_yaw - pitched * sin_yaw, pitched * cos_yaw + rolled * sin_yaw, both_cos * sin_yaw - both_sin * cos_yaw,
    both_cos * cos_yaw + both_sin * sin_yaw);
}

Angles angles(const Quaternion & rotation)
{
  const auto & [x, y, z, w] = rotation;
  // Divides by the squared length where it matters, instead of normalizing first: atan2 does not need it.
  const double square = x * x + y * y + z * z + w * w;
  if (square == 0.0) {
    return {0.0, 0.0, 0.0};
  }
  const double sine = 2 * (w * y - z * x) / square;
  // With roll 0 and pitch 90 degrees, w is cos(yaw / 2) and z is sin(yaw / 2), both times sqrt(1/2).
  if (std::abs(sine) >= STRAIGHT) {
    return {0.0, std::copysign(PI / 2, sine), 2 * std::atan2(z, w)};
  }
  return {
    std::atan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z), std::asin(sine),
    std::atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)};
}

}  // namespace roverlink
