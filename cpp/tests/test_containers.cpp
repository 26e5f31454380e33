#include <roverlink/containers.hpp>

#include <google/protobuf/struct.pb.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "refusal.hpp"

namespace
{

/// Sequence of at most two elements, like rosidl's BoundedVector.
struct Bounded : std::vector<int>
{
  std::size_t max_size() const
  {
    return 2;
  }
};

const auto twice = [](int value) { return 2 * value; };

TEST(Containers, EntriesAreSortedByTheirKeys)
{
  google::protobuf::Struct payload;
  for (const char * key : {"b", "c", "a"}) {
    roverlink::added(*payload.mutable_fields(), std::string(key), "f").set_bool_value(true);
  }
  std::string keys;
  for (const auto * entry : roverlink::sorted(payload.fields())) {
    keys += std::string(entry->first);
  }
  EXPECT_EQ(keys, "abc");
}

TEST(Containers, ARepeatedKeyIsRefused)
{
  google::protobuf::Struct payload;
  roverlink::added(*payload.mutable_fields(), std::string("a"), "f");
  EXPECT_NE(refusal([&] { roverlink::added(*payload.mutable_fields(), std::string("a"), "f"); }), "");
}

TEST(Containers, AnArrayTakesExactlyItsLength)
{
  std::array<int, 2> target = {};
  roverlink::fill(target, std::vector<int>{1, 2}, "f", twice);
  EXPECT_EQ(target, (std::array<int, 2>{2, 4}));
  EXPECT_NE(refusal([&] { roverlink::fill(target, std::vector<int>{1}, "f", twice); }), "");
  EXPECT_NE(refusal([&] { roverlink::fill(target, std::vector<int>{1, 2, 3}, "f", twice); }), "");
}

TEST(Containers, ASequenceTakesUpToItsBound)
{
  Bounded target;
  target.push_back(9);
  roverlink::fill(target, std::vector<int>{1, 2}, "f", twice);
  EXPECT_EQ(target, (std::vector<int>{2, 4}));
  EXPECT_NE(refusal([&] { roverlink::fill(target, std::vector<int>{1, 2, 3}, "f", twice); }), "");
}

}  // namespace
