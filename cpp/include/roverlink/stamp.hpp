#ifndef ROVERLINK__STAMP_HPP_
#define ROVERLINK__STAMP_HPP_

#include <cstdint>

#include <roverlink/numbers.hpp>

namespace roverlink
{

/// Seconds, and the nanoseconds to add to them: a time since 1970, or a duration.
///
/// It converts from and to every struct with these two members, so this library needs no builtin_interfaces.
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

/// Split nanoseconds into seconds and nanoseconds. Throws ConversionError if the seconds do not fit an int32.
Stamp stamp_of(Wide nanoseconds, const char * field);

/// Join seconds and nanoseconds into nanoseconds.
inline Wide nanoseconds(const Stamp & stamp)
{
  return wide(stamp.sec) * 1'000'000'000 + wide(stamp.nanosec);
}

}  // namespace roverlink

#endif  // ROVERLINK__STAMP_HPP_
