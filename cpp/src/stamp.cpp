#include <roverlink/stamp.hpp>

namespace roverlink
{

Stamp stamp_of(Wide nanoseconds, const char * field)
{
  constexpr Wide SECOND = 1'000'000'000;
  const auto seconds = narrow<std::int32_t>(floored(nanoseconds, SECOND), field);
  return Stamp(seconds, static_cast<std::uint32_t>(nanoseconds - wide(seconds) * SECOND));
}

}  // namespace roverlink
