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

// All functions throw ConversionError for values that the other side cannot hold.

/// Convert a timestamp to a time, which can be from 1901 to 2038.
Stamp timestamp_to_ros(const google::protobuf::Timestamp & payload, const char * field);

/// Convert a time to a timestamp.
google::protobuf::Timestamp timestamp_from_ros(const Stamp & message, const char * field);

/// Convert a duration of at most 68 years.
///
/// In protobuf, seconds and nanoseconds have the same sign; ROS 2 rounds the seconds down.
Stamp duration_to_ros(const google::protobuf::Duration & payload, const char * field);

/// Convert a duration of ROS 2.
google::protobuf::Duration duration_from_ros(const Stamp & message, const char * field);

/// Return the paths of a field mask.
std::vector<std::string> field_mask_to_ros(const google::protobuf::FieldMask & payload, const char * field);

/// Make a field mask from paths.
google::protobuf::FieldMask field_mask_from_ros(const std::vector<std::string> & paths, const char * field);

}  // namespace roverlink

#endif  // ROVERLINK__WELL_KNOWN_HPP_
