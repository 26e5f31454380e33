#include <roverlink/text.hpp>

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "refusal.hpp"

namespace
{

TEST(Text, Utf8IsKept)
{
  for (const std::string value : {"", "a", "\u00fc", "\u20ac", "\U0001F600", "\uD7FF\uE000", "\U0010FFFF"}) {
    EXPECT_EQ(roverlink::text(value, "f"), value);
  }
}

TEST(Text, OtherBytesAreRefused)
{
  for (const std::string value :
       {"\xff", "\xc3", "\x80", "\xc0\x80", "\xe0\x80\x80", "\xed\xa0\x80", "\xf0\x80\x80\x80", "\xf4\x90\x80\x80",
        "\xe2\x82", "a\xf5"}) {
    EXPECT_EQ(refusal([&] { roverlink::text(value, "f"); }), "f: is not UTF-8");
  }
}

TEST(Text, ANulCharacterIsRefused)
{
  EXPECT_NE(refusal([] { roverlink::text(std::string("a\0b", 3), "f"); }), "");
}

TEST(Text, TheBoundCountsBytes)
{
  EXPECT_EQ(roverlink::text("\u00fc", "f", 2), "\u00fc");
  EXPECT_EQ(refusal([] { roverlink::text("\u00fc", "f", 1); }), "f: has more than 1 bytes");
}

TEST(Text, BytesAreKept)
{
  const std::string value("\0\xff", 2);
  EXPECT_EQ(roverlink::bytes(roverlink::octets(value)), value);
  EXPECT_EQ(roverlink::bytes(std::array<unsigned char, 2>{0, 255}), value);
}

}  // namespace
