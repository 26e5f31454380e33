#include <roverlink/any.hpp>
#include <roverlink/registry.hpp>

#include <google/protobuf/struct.pb.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "refusal.hpp"

namespace
{

using Envelope = google::protobuf::Value;
using roverlink::Stamp;

/// Handler as the generator writes it, for the payload bool_value.
class FlagHandler final : public roverlink::Handler<Envelope>
{
public:
  using Message = std::string;

  static constexpr roverlink::Route ROUTE{Envelope::kBoolValue, "flag", "flag", "board_to_ros"};

  explicit FlagHandler(roverlink::Publish<Message> publish)
  : publish_(std::move(publish))
  {
  }

  const roverlink::Route & route() const override
  {
    return ROUTE;
  }

private:
  void publish(const Envelope & envelope, const Stamp & received) const override
  {
    publish_((envelope.bool_value() ? "true at " : "false at ") + std::to_string(received.sec));
  }

  roverlink::Publish<Message> publish_;
};

using Registry = roverlink::Registry<Envelope, &Envelope::kind_case>;

Envelope flag()
{
  Envelope envelope;
  envelope.set_bool_value(true);
  return envelope;
}

TEST(Registry, AnEnvelopeReachesEveryHandlerOfItsPayload)
{
  std::vector<std::string> published;
  auto registry = Registry::of<roverlink::Table<FlagHandler>>([&](auto topic) {
    EXPECT_STREQ(topic.route.topic, "flag");
    return [&](const std::string & message) { published.push_back(message); };
  });
  registry.add<FlagHandler>([&](const std::string & message) { published.push_back("also " + message); });
  EXPECT_EQ(registry.dispatch(flag(), Stamp(7, 0)), 2U);
  EXPECT_EQ(published, (std::vector<std::string>{"true at 7", "also true at 7"}));
}

TEST(Registry, AnEnvelopeWithoutHandlerIsLeft)
{
  EXPECT_EQ(Registry().dispatch(flag()), 0U);
  EXPECT_EQ(Registry().dispatch(Envelope()), 0U);
}

TEST(Registry, ARefusalNamesTheRowAndKeepsNoOtherTopicFromPublishing)
{
  int published = 0;
  Registry registry;
  registry.add<FlagHandler>([](const std::string &) { throw roverlink::ConversionError("Flag.value", "no"); });
  registry.add<FlagHandler>([&](const std::string &) { ++published; });
  EXPECT_EQ(refusal([&] { registry.dispatch(flag()); }), "flag.Flag.value: no");
  EXPECT_EQ(published, 1);
}

TEST(Any, AMessageComesBack)
{
  const auto any = roverlink::packed(flag());
  EXPECT_TRUE(roverlink::holds<Envelope>(any));
  EXPECT_FALSE(roverlink::holds<google::protobuf::Struct>(any));
  EXPECT_TRUE(roverlink::unpacked<Envelope>(any, "f").bool_value());
}

TEST(Any, WhatHasNoFieldIsRefused)
{
  roverlink::check_empty(google::protobuf::Any(), "f");
  EXPECT_NE(refusal([] { roverlink::check_empty(roverlink::packed(flag()), "f"); }), "");
  auto any = roverlink::packed(flag());
  any.set_value("\xff");
  EXPECT_EQ(refusal([&] { roverlink::unpacked<Envelope>(any, "f"); }), "f: its bytes are not a google.protobuf.Value");
}

}  // namespace
