#include <roverlink/well_known.hpp>

#include <cstdint>

#include <roverlink/text.hpp>

namespace roverlink
{

namespace
{

constexpr std::int32_t SECOND = 1'000'000'000;

Stamp checked(Wide seconds, std::int64_t nanoseconds, const char * field)
{
  const auto sec = narrow<std::int32_t>(seconds, field);
  if (nanoseconds < 0 || nanoseconds >= SECOND) {
    throw ConversionError(field, digits(nanoseconds) + " nanoseconds are out of range (0 to 999999999)");
  }
  return Stamp(sec, static_cast<std::uint32_t>(nanoseconds));
}

}  // namespace

Stamp timestamp_to_ros(const google::protobuf::Timestamp & payload, const char * field)
{
  return checked(payload.seconds(), payload.nanos(), field);
}

google::protobuf::Timestamp timestamp_from_ros(const Stamp & message, const char * field)
{
  checked(message.sec, message.nanosec, field);
  google::protobuf::Timestamp payload;
  payload.set_seconds(message.sec);
  payload.set_nanos(static_cast<std::int32_t>(message.nanosec));
  return payload;
}

Stamp duration_to_ros(const google::protobuf::Duration & payload, const char * field)
{
  const std::int64_t seconds = payload.seconds();
  const std::int64_t nanoseconds = payload.nanos();
  if (nanoseconds <= -SECOND || nanoseconds >= SECOND) {
    throw ConversionError(field, digits(nanoseconds) + " nanoseconds are a second or more; protobuf allows less");
  }
  if ((seconds < 0 && nanoseconds > 0) || (seconds > 0 && nanoseconds < 0)) {
    throw ConversionError(field, "seconds and nanoseconds have different signs");
  }
  const bool down = nanoseconds < 0;
  return checked(wide(seconds) - down, nanoseconds + (down ? SECOND : 0), field);
}

google::protobuf::Duration duration_from_ros(const Stamp & message, const char * field)
{
  checked(message.sec, message.nanosec, field);
  const bool up = message.sec < 0 && message.nanosec > 0;
  google::protobuf::Duration payload;
  payload.set_seconds(message.sec + (up ? 1 : 0));
  payload.set_nanos(static_cast<std::int32_t>(message.nanosec) - (up ? SECOND : 0));
  return payload;
}

std::vector<std::string> field_mask_to_ros(const google::protobuf::FieldMask & payload, const char * field)
{
  std::vector<std::string> paths;
  for (const auto & path : payload.paths()) {
    paths.push_back(text(path, field));
  }
  return paths;
}

google::protobuf::FieldMask field_mask_from_ros(const std::vector<std::string> & paths, const char * field)
{
  google::protobuf::FieldMask payload;
  for (const auto & path : paths) {
    payload.add_paths(text(path, field));
  }
  return payload;
}

}  // namespace roverlink
