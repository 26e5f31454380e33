// Observes arrivals: samples on the topic rt/imu_data, or datagrams at a UDP port.
//
//   observe dds
//   observe udp PORT HIGH_OFFSET LOW_OFFSET
//
// Each line on stdin prints as JSON how many have arrived since the line before, and their ages on arrival.
#include "cyclone.hpp"
#include "messages.h"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstring>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

class Arrivals {
 public:
  void add(const Stamp& stamp) {
    const int64_t age = stamp.age_ns();
    const std::lock_guard<std::mutex> lock(mutex_);
    ages_ns_.push_back(age);
  }

  std::vector<int64_t> take() {
    std::vector<int64_t> ages;
    ages.reserve(1 << 20);  // avoids reallocation during a measurement
    const std::lock_guard<std::mutex> lock(mutex_);
    ages.swap(ages_ns_);
    return ages;
  }

 private:
  std::mutex mutex_;
  std::vector<int64_t> ages_ns_;
};

Arrivals arrivals;

void on_data_available(dds_entity_t reader, void*) {
  constexpr int most = 64;
  static comms_msg_dds__ImuSensorInformation_ samples[most];
  void* places[most];
  dds_sample_info_t infos[most];
  for (int i = 0; i < most; ++i) places[i] = &samples[i];
  for (int taken = most; taken == most;) {
    taken = checked(dds_take(reader, places, infos, most, most), "dds_take");
    for (int i = 0; i < taken; ++i) {
      if (infos[i].valid_data) arrivals.add({samples[i].gyro_x, samples[i].gyro_y});
    }
  }
}

// A listener, because it runs on the thread that received the sample: the cheapest subscriber possible.
void watch_dds() {
  const dds_entity_t participant = ros_participant();
  const dds_entity_t topic = checked(
      dds_create_topic(participant, &comms_msg_dds__ImuSensorInformation__desc, "rt/imu_data", nullptr, nullptr),
      "dds_create_topic");
  dds_listener_t* listener = dds_create_listener(nullptr);
  dds_lset_data_available(listener, on_data_available);
  checked(dds_create_reader(participant, topic, ros_qos(0), listener), "dds_create_reader");
}

void watch_udp(int port, size_t high_offset, size_t low_offset) {
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int buffer = 4 << 20;
  const int receiver = checked(socket(AF_INET, SOCK_DGRAM, 0), "socket");
  checked(setsockopt(receiver, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer), "setsockopt");
  checked(bind(receiver, reinterpret_cast<sockaddr*>(&at), sizeof at), "bind");
  std::thread([=] {
    uint8_t datagram[2048];
    for (;;) {
      const auto size = static_cast<size_t>(checked(recv(receiver, datagram, sizeof datagram, 0), "recv"));
      Stamp stamp;
      if (std::max(high_offset, low_offset) + sizeof(float) > size) continue;
      std::memcpy(&stamp.high, datagram + high_offset, sizeof stamp.high);
      std::memcpy(&stamp.low, datagram + low_offset, sizeof stamp.low);
      arrivals.add(stamp);
    }
  }).detach();
}

double percentile_us(const std::vector<int64_t>& sorted_ns, double part) {
  return sorted_ns[static_cast<size_t>(part * (sorted_ns.size() - 1))] / 1e3;
}

int main(int count, char** words) {
  const std::vector<std::string> arguments(words + 1, words + count);
  arrivals.take();
  if (arguments.size() == 1 && arguments[0] == "dds") {
    watch_dds();
  } else if (arguments.size() == 4 && arguments[0] == "udp") {
    watch_udp(std::stoi(arguments[1]), std::stoul(arguments[2]), std::stoul(arguments[3]));
  } else {
    std::cerr << "observe dds | observe udp PORT HIGH_OFFSET LOW_OFFSET\n";
    return 2;
  }
  for (std::string line; std::getline(std::cin, line);) {
    auto ages = arrivals.take();
    std::sort(ages.begin(), ages.end());
    std::cout << "{\"received\": " << ages.size();
    if (!ages.empty()) {
      std::cout << ", \"p50_us\": " << percentile_us(ages, 0.50) << ", \"p99_us\": " << percentile_us(ages, 0.99);
    }
    std::cout << "}" << std::endl;
  }
  if (arguments[0] == "dds") dds_delete(DDS_CYCLONEDDS_HANDLE);  // writers then forget this reader immediately
  std::_Exit(0);  // the UDP thread needs no clean-up
}
