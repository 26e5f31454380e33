#ifndef ROVERLINK__ROTATIONS_HPP_
#define ROVERLINK__ROTATIONS_HPP_

namespace roverlink
{

/// Angles of rotations about the fixed axes x, y and z, applied in this order, in radians (REP 103).
struct Angles
{
  double roll;
  double pitch;
  double yaw;
};

/// Rotation as a quaternion. It converts from and to any struct with the same members, such as
/// geometry_msgs::msg::Quaternion.
struct Quaternion
{
  double x;
  double y;
  double z;
  double w;

  Quaternion(double x, double y, double z, double w)
  : x(x),
    y(y),
    z(z),
    w(w)
  {
  }

  // A template instead of the message's type: this library is built without ROS 2, and its tests run without it.
  template<typename Message, typename = decltype(Message::w)>
  Quaternion(const Message & message)
  : x(message.x),
    y(message.y),
    z(message.z),
    w(message.w)
  {
  }

  template<typename Message, typename = decltype(Message::w)>
  operator Message() const
  {
    Message message;
    message.x = x;
    message.y = y;
    message.z = z;
    message.w = w;
    return message;
  }
};

/// Convert angles to a quaternion of length 1. Throws ConversionError if an angle is infinite.
Quaternion quaternion(const Angles & angles, const char * field);

/// Convert a quaternion to angles.
///
/// At a pitch of 90 degrees up or down, only the sum or the difference of roll and yaw is defined. Then roll is 0, and
/// the whole rotation is in yaw. The quaternion need not have the length 1. If its length is 0, all angles are 0.
Angles angles(const Quaternion & rotation);

}  // namespace roverlink

#endif  // ROVERLINK__ROTATIONS_HPP_
