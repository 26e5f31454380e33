#include <roverlink/json.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "refusal.hpp"

namespace
{

using google::protobuf::ListValue;
using google::protobuf::Value;

std::string rewritten(const std::string & text)
{
  return roverlink::json_value_to_ros(roverlink::json_value_from_ros(text, "f"), "f");
}

Value number(double value)
{
  Value made;
  made.set_number_value(value);
  return made;
}

TEST(Json, TextsMeanWhatTheyMeanInPython)
{
  std::ifstream texts(JSON_TEXTS);
  int count = 0;
  for (std::string line; std::getline(texts, line);) {
    if (line[0] == '#') {
      continue;
    }
    const auto first = line.find('\t'), second = line.find('\t', first + 1);
    const std::string kind = line.substr(0, first), text = line.substr(first + 1, second - first - 1);
    const std::string written = line.substr(second + 1), refused = refusal([&] { rewritten(text); });
    if (kind != "lenient") {
      EXPECT_EQ(refused.empty(), kind == "same") << line << "\n" << refused;
    }
    if (refused.empty()) {
      EXPECT_EQ(rewritten(text), written) << line;
    }
    ++count;
  }
  EXPECT_GT(count, 100);
}

TEST(Json, DoublesKeepTheirBits)
{
  for (const double value : {0.1, -0.0, 5e-324, 1.7976931348623157e308, 1e22, 1e-5, 123456789.123456789}) {
    const Value back = roverlink::json_value_from_ros(roverlink::json_value_to_ros(number(value), "f"), "f");
    EXPECT_EQ(back.number_value(), value);
    EXPECT_EQ(std::signbit(back.number_value()), std::signbit(value));
  }
}

TEST(Json, WhatIsNotUtf8IsRefused)
{
  EXPECT_NE(refusal([] { rewritten("\"\xff\""); }), "");
  EXPECT_NE(refusal([] { rewritten(std::string("\"\0\"", 3)); }), "");
}

TEST(Json, AnotherKindIsRefused)
{
  EXPECT_EQ(refusal([] { roverlink::json_struct_from_ros("[]", "f"); }), "f: is JSON, but not an object");
  EXPECT_EQ(refusal([] { roverlink::json_struct_from_ros("null", "f"); }), "f: is JSON, but not an object");
  EXPECT_EQ(refusal([] { roverlink::json_list_from_ros("{}", "f"); }), "f: is JSON, but not an array");
}

TEST(Json, AnObjectAndAnArrayComeBack)
{
  EXPECT_EQ(
    roverlink::json_struct_to_ros(roverlink::json_struct_from_ros("{\"b\":1,\"a\":[]}", "f"), "f"),
    "{\"a\": [], \"b\": 1.0}");
  EXPECT_EQ(roverlink::json_list_to_ros(roverlink::json_list_from_ros("[1,{}]", "f"), "f"), "[1.0, {}]");
}

TEST(Json, AValueThatJsonCannotHoldIsRefused)
{
  for (const Value & value : {Value(), number(std::nan("")), number(-HUGE_VAL)}) {
    EXPECT_NE(refusal([&] { roverlink::json_value_to_ros(value, "f"); }), "");
    ListValue list;
    *list.add_values() = value;
    EXPECT_NE(refusal([&] { roverlink::json_list_to_ros(list, "f"); }), "");
  }
}

}  // namespace
