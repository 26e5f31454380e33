// Common parts of the C++ programs of the benchmarks: Cyclone DDS set up like a ROS 2 node, and the stamp for the
// latency.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>

// Ends the program with a message if a call to the system or to DDS failed; both return a negative number then.
template <typename Result>
Result checked(Result result, const char* what) {
  if (result < 0) {
    std::fprintf(stderr, "%s failed (%ld)\n", what, static_cast<long>(result));
    std::exit(2);
  }
  return result;
}

// A participant in the domain ROS_DOMAIN_ID, as rcl creates it; CYCLONEDDS_URI restricts it to loopback.
inline dds_entity_t ros_participant() {
  const char* domain = std::getenv("ROS_DOMAIN_ID");
  return checked(dds_create_participant(domain ? std::atoi(domain) : 0, nullptr, nullptr), "dds_create_participant");
}

// rclcpp's default QoS: reliable, volatile, keep last `depth` samples; depth 0 means keep all. XCDR1 is the only
// encoding that ROS 2 reads.
inline dds_qos_t* ros_qos(int32_t depth) {
  dds_qos_t* qos = dds_create_qos();
  dds_data_representation_id_t encoding = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, depth ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL, depth);
  dds_qset_writer_data_lifecycle(qos, false);
  dds_qset_data_representation(qos, 1, &encoding);
  return qos;
}

inline int64_t monotonic_ns() {
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

// A time as two floats, each of which holds 20 bits exactly: nanoseconds modulo 18 minutes. Both count from 1, because
// a proto3 field with the value 0 is left out of the datagram, while the stamp is read at a fixed offset.
struct Stamp {
  static constexpr int64_t half = 1 << 20;
  float high, low;

  static Stamp now() {
    const int64_t ns = monotonic_ns();
    return {static_cast<float>(ns / half % half + 1), static_cast<float>(ns % half + 1)};
  }

  int64_t age_ns() const {
    const int64_t then = (static_cast<int64_t>(high) - 1) * half + static_cast<int64_t>(low) - 1;
    return (monotonic_ns() - then) & (half * half - 1);
  }
};
