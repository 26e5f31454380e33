#include <roverlink/well_known.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "refusal.hpp"

namespace
{

using google::protobuf::Duration;
using google::protobuf::Timestamp;
using roverlink::Stamp;

/// Stand-in for builtin_interfaces::msg::Time.
struct Time
{
  std::int32_t sec;
  std::uint32_t nanosec;
};

template<typename Payload>
Payload payload(std::int64_t seconds, std::int32_t nanos)
{
  Payload made;
  made.set_seconds(seconds);
  made.set_nanos(nanos);
  return made;
}

template<typename Payload>
void expect_same(const Payload & payload, const Payload & other)
{
  EXPECT_EQ(payload.SerializeAsString(), other.SerializeAsString());
}

TEST(Stamp, ConvertsFromAndToStructs)
{
  Time time;
  time = Stamp(1, 2);
  EXPECT_EQ(time.sec, 1);
  EXPECT_EQ(time.nanosec, 2U);
  EXPECT_EQ(roverlink::digits(roverlink::nanoseconds(time)), "1000000002");
}

TEST(Stamp, SecondsOfNanosecondsAreRoundedDown)
{
  const Stamp stamp = roverlink::stamp_of(-1, "f");
  EXPECT_EQ(stamp.sec, -1);
  EXPECT_EQ(stamp.nanosec, 999'999'999U);
  EXPECT_NE(refusal([] { roverlink::stamp_of(roverlink::wide(1LL << 31) * 1'000'000'000, "f"); }), "");
}

TEST(WellKnown, ATimestampIsATime)
{
  for (const auto seconds : {std::int64_t(0), std::int64_t(-1), (std::int64_t(1) << 31) - 1}) {
    const auto one = payload<Timestamp>(seconds, 5);
    const Stamp stamp = roverlink::timestamp_to_ros(one, "f");
    EXPECT_EQ(stamp.sec, seconds);
    EXPECT_EQ(stamp.nanosec, 5U);
    expect_same(roverlink::timestamp_from_ros(stamp, "f"), one);
  }
}

TEST(WellKnown, ATimestampThatIsNoTimeIsRefused)
{
  const auto refused = {
    payload<Timestamp>(std::int64_t(1) << 31, 0), payload<Timestamp>(0, -1), payload<Timestamp>(0, 1'000'000'000)};
  for (const auto & one : refused) {
    EXPECT_NE(refusal([&] { roverlink::timestamp_to_ros(one, "f"); }), "");
  }
  EXPECT_NE(refusal([] { roverlink::timestamp_from_ros(Stamp(0, 1'000'000'000), "f"); }), "");
}

TEST(WellKnown, ADurationKeepsItsSign)
{
  const Stamp half = roverlink::duration_to_ros(payload<Duration>(0, -500'000'000), "f");
  EXPECT_EQ(half.sec, -1);
  EXPECT_EQ(half.nanosec, 500'000'000U);
  for (const auto & one : {payload<Duration>(0, -500'000'000), payload<Duration>(-1, -1), payload<Duration>(1, 1)}) {
    expect_same(roverlink::duration_from_ros(roverlink::duration_to_ros(one, "f"), "f"), one);
  }
}

TEST(WellKnown, ADurationThatIsNoneIsRefused)
{
  const auto refused = {
    payload<Duration>(1, -1), payload<Duration>(-1, 1), payload<Duration>(0, 1'000'000'000),
    payload<Duration>(std::int64_t(1) << 31, 0), payload<Duration>(std::numeric_limits<std::int64_t>::min(), -1)};
  for (const auto & one : refused) {
    EXPECT_NE(refusal([&] { roverlink::duration_to_ros(one, "f"); }), "");
  }
}

TEST(WellKnown, AFieldMaskIsItsPaths)
{
  const std::vector<std::string> paths = {"a", "b.c"};
  EXPECT_EQ(roverlink::field_mask_to_ros(roverlink::field_mask_from_ros(paths, "f"), "f"), paths);
  EXPECT_NE(refusal([] { roverlink::field_mask_from_ros({"\xff"}, "f"); }), "");
}

}  // namespace
