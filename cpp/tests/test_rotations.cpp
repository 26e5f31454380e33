#include <roverlink/rotations.hpp>

#include <gtest/gtest.h>

#include <cmath>

#include "refusal.hpp"

namespace
{

/// Stand-in for geometry_msgs::msg::Quaternion.
struct Message
{
  double x = 0;
  double y = 0;
  double z = 0;
  double w = 1;
};

constexpr double QUARTER = 1.5707963267948966;

TEST(Rotations, AQuarterTurnAboutZ)
{
  const Message message = roverlink::quaternion({0, 0, QUARTER}, "f");
  EXPECT_DOUBLE_EQ(message.z, std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(message.w, std::sqrt(0.5));
  EXPECT_EQ(message.x, 0);
  EXPECT_EQ(message.y, 0);
}

TEST(Rotations, AnglesComeBack)
{
  const Message message = roverlink::quaternion({0.1, -0.2, 3}, "f");
  const auto angles = roverlink::angles(message);
  EXPECT_NEAR(angles.roll, 0.1, 1e-15);
  EXPECT_NEAR(angles.pitch, -0.2, 1e-15);
  EXPECT_NEAR(angles.yaw, 3, 1e-15);
}

TEST(Rotations, StraightUpAllIsYaw)
{
  const auto angles = roverlink::angles(roverlink::quaternion({0.25, QUARTER, 1}, "f"));
  EXPECT_EQ(angles.roll, 0);
  EXPECT_DOUBLE_EQ(angles.pitch, QUARTER);
  EXPECT_NEAR(angles.yaw, 0.75, 1e-9);
}

TEST(Rotations, TheLengthDoesNotMatter)
{
  EXPECT_NEAR(roverlink::angles(roverlink::Quaternion(0, 0, 7, 7)).yaw, QUARTER, 1e-15);
  EXPECT_EQ(roverlink::angles(roverlink::Quaternion(0, 0, 0, 0)).yaw, 0);
}

TEST(Rotations, AnInfiniteAngleIsRefused)
{
  EXPECT_EQ(refusal([] { roverlink::quaternion({0, HUGE_VAL, 0}, "f"); }), "f: an angle cannot be infinite");
}

}  // namespace
