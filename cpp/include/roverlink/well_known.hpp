#ifndef ROVERLINK__WELL_KNOWN_HPP_
#define ROVERLINK__WELL_KNOWN_HPP_

#include <google/protobuf/duration.pb.h>
#include <google/protobuf/field_mask.pb.h>
#include <google/protobuf/timestamp.pb.h>

#include <string>
#include <vector>

#include <roverlink/stamp.hpp>

namespace roverlink
{

// All functions throw ConversionError for a value that the type of the result cannot hold.

/// Convert a protobuf timestamp to a ROS 2 time. A ROS 2 time can be from 1901 to 2038.
Stamp timestamp_to_ros(const google::protobuf::Timestamp & payload, const char * field);

/// Convert a ROS 2 time to a protobuf timestamp.
google::protobuf::Timestamp timestamp_from_ros(const Stamp & message, const char * field);

/// Convert a protobuf duration of at most 68 years to a ROS 2 duration.
///
/// In protobuf, seconds and nanoseconds have the same sign; in ROS 2, nanoseconds are never negative.
Stamp duration_to_ros(const google::protobuf::Duration & payload, const char * field);

/// Convert a ROS 2 duration to a protobuf duration.
google::protobuf::Duration duration_from_ros(const Stamp & message, const char * field);

/// Return the paths of a protobuf FieldMask as a sequence of texts.
std::vector<std::string> field_mask_to_ros(const google::protobuf::FieldMask & payload, const char * field);

/// Return a protobuf FieldMask with these paths.
google::protobuf::FieldMask field_mask_from_ros(const std::vector<std::string> & paths, const char * field);

}  // namespace roverlink

#endif  // ROVERLINK__WELL_KNOWN_HPP_
