#ifndef ROVERLINK__STAMP_HPP_
#define ROVERLINK__STAMP_HPP_

#include <cstdint>

#include <roverlink/numbers.hpp>

namespace roverlink
{

/// Time since 1970, or duration: seconds, and nanoseconds that are added to the seconds.
///
/// It converts from and to any struct with the same two members, so this library does not need builtin_interfaces.
struct Stamp
{
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;

  Stamp() = default;

  Stamp(std::int32_t sec, std::uint32_t nanosec)
  : sec(sec),
    nanosec(nanosec)
  {
  }

  template<typename Message, typename = decltype(Message::nanosec)>
  Stamp(const Message & message)
  : sec(message.sec),
    nanosec(message.nanosec)
  {
  }

  template<typename Message, typename = decltype(Message::nanosec)>
  operator Message() const
  {
    Message message;
    message.sec = sec;
    message.nanosec = nanosec;
    return message;
  }
};

/// Convert a number of nanoseconds to a Stamp. Throws ConversionError if the seconds do not fit int32.
Stamp stamp_of(Wide nanoseconds, const char * field);

/// Convert a Stamp to a number of nanoseconds.
inline Wide nanoseconds(const Stamp & stamp)
{
  return wide(stamp.sec) * 1'000'000'000 + wide(stamp.nanosec);
}

}  // namespace roverlink

#endif  // ROVERLINK__STAMP_HPP_
