#include <roverlink/numbers.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "refusal.hpp"

namespace
{

using roverlink::narrow;
using roverlink::Wide;

constexpr auto LARGEST = std::numeric_limits<std::uint64_t>::max();
constexpr auto SMALLEST = std::numeric_limits<std::int64_t>::min();

TEST(Numbers, AWideHasTheDigitsOfEveryInteger)
{
  EXPECT_EQ(roverlink::digits(0), "0");
  EXPECT_EQ(roverlink::digits(LARGEST), "18446744073709551615");
  EXPECT_EQ(roverlink::digits(SMALLEST), "-9223372036854775808");
  EXPECT_EQ(roverlink::digits(roverlink::wide(LARGEST) * 1000), "18446744073709551615000");
}

TEST(Numbers, NarrowKeepsWhatFits)
{
  EXPECT_EQ(narrow<std::uint8_t>(255, "f"), 255);
  EXPECT_EQ(narrow<std::int8_t>(-128, "f"), -128);
  EXPECT_EQ(narrow<std::int64_t>(SMALLEST, "f"), SMALLEST);
  EXPECT_EQ(narrow<std::uint64_t>(LARGEST, "f"), LARGEST);
}

TEST(Numbers, NarrowRefusesWhatDoesNotFit)
{
  EXPECT_EQ(refusal([] { narrow<std::uint8_t>(256, "Row.field"); }), "Row.field: 256 does not fit uint8");
  EXPECT_EQ(refusal([] { narrow<std::uint8_t>(-1, "f"); }), "f: -1 does not fit uint8");
  EXPECT_EQ(refusal([] { narrow<std::int64_t>(LARGEST, "f"); }), "f: 18446744073709551615 does not fit int64");
}

TEST(Numbers, HalvesAreRoundedToTheEvenInteger)
{
  EXPECT_EQ(roverlink::rounded<int>(0.5, "f"), 0);
  EXPECT_EQ(roverlink::rounded<int>(1.5, "f"), 2);
  EXPECT_EQ(roverlink::rounded<int>(-2.5, "f"), -2);
  EXPECT_EQ(roverlink::digits(roverlink::whole(0x1p99, "f")), "633825300114114700748351602688");
}

TEST(Numbers, WhatIsNoIntegerIsRefused)
{
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL, 0x1p100}) {
    EXPECT_NE(refusal([&] { roverlink::whole(value, "f"); }), "") << value;
  }
  EXPECT_NE(refusal([] { roverlink::rounded<std::uint8_t>(255.5, "f"); }), "");
}

TEST(Numbers, AFiniteNumberStaysFinite)
{
  EXPECT_EQ(roverlink::single(0.1, "f"), 0.1F);
  EXPECT_TRUE(std::isinf(roverlink::single(HUGE_VAL, "f")));
  EXPECT_TRUE(std::isnan(roverlink::single(std::nan(""), "f")));
  EXPECT_NE(refusal([] { roverlink::single(1e39, "f"); }), "");
}

TEST(Numbers, QuotientsAreRoundedDown)
{
  EXPECT_EQ(roverlink::floored(7, 2), Wide(3));
  EXPECT_EQ(roverlink::floored(-7, 2), Wide(-4));
  EXPECT_EQ(roverlink::floored(-8, 2), Wide(-4));
}

}  // namespace
