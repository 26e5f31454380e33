#include <roverlink/enums.hpp>

#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/struct.pb.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "refusal.hpp"

namespace
{

using Closed = google::protobuf::FieldDescriptorProto::Type;
using Open = google::protobuf::NullValue;
using roverlink::Enumerator;

TEST(Enums, ADeclaredNumberIsAValue)
{
  const Closed value = Enumerator(google::protobuf::FieldDescriptorProto_Type_TYPE_BOOL, "f");
  EXPECT_EQ(value, google::protobuf::FieldDescriptorProto_Type_TYPE_BOOL);
}

TEST(Enums, AClosedEnumRefusesOtherNumbers)
{
  const auto convert = [] { [[maybe_unused]] const Closed value = Enumerator(99, "f"); };
  EXPECT_EQ(refusal(convert), "f: 99 is not a value of google.protobuf.FieldDescriptorProto.Type");
}

TEST(Enums, AnOpenEnumTakesEveryInt32)
{
  const Open value = Enumerator(99, "f");
  EXPECT_EQ(static_cast<int>(value), 99);
  const auto convert = [] { [[maybe_unused]] const Open value = Enumerator(std::int64_t(1) << 31, "f"); };
  EXPECT_EQ(refusal(convert), "f: 2147483648 does not fit int32");
}

TEST(Enums, ErrorsShowTheValue)
{
  EXPECT_STREQ(roverlink::no_member(7, "f").what(), "f: 7 is not the number of a member");
  const std::string unlisted = " is not among the values that the table lists for it";
  EXPECT_EQ(roverlink::no_counterpart("f", std::uint8_t(7)).what(), "f: 7" + unlisted);
  EXPECT_EQ(roverlink::no_counterpart("f", std::string("idle")).what(), "f: \"idle\"" + unlisted);
}

}  // namespace
