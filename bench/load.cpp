// Generates load: datagrams to a UDP port, or samples on the topic rt/drive_motor.
//
//   load udp PORT DATAGRAM_HEX HIGH_OFFSET LOW_OFFSET
//   load dds
//
// Each line "RATE SECONDS" on stdin sends RATE per second (0: as many as possible) for SECONDS, then prints the number
// sent as JSON. Every datagram and sample carries its time of sending (Stamp).
#include "cyclone.hpp"
#include "messages.h"

#include <arpa/inet.h>
#include <netinet/udp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

using Send = std::function<void(int count)>;
constexpr int batch = 64;
constexpr int64_t burst_ns = 1'000'000;  // interval of a paced load, which sends all that is due

std::vector<uint8_t> bytes_of(const std::string& hex) {
  std::vector<uint8_t> bytes;
  for (size_t i = 0; i < hex.size(); i += 2) bytes.push_back(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

// Copies of one datagram, which the kernel cuts from one large message (udp(7), UDP_SEGMENT). A single core can send
// several 100,000 per second that way, and takes little CPU from the bridge on the same machine.
class Datagrams {
 public:
  Datagrams(int port, const std::vector<uint8_t>& datagram, int high_offset, int low_offset)
      : size_(static_cast<int>(datagram.size())), high_offset_(high_offset), low_offset_(low_offset) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socket_ = checked(socket(AF_INET, SOCK_DGRAM, 0), "socket");
    checked(connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof to), "connect");
    checked(setsockopt(socket_, IPPROTO_UDP, UDP_SEGMENT, &size_, sizeof size_), "UDP_SEGMENT");
    for (int i = 0; i < batch; ++i) copies_.insert(copies_.end(), datagram.begin(), datagram.end());
  }

  void send(int count) {
    for (int i = 0; i < count; ++i) {
      const Stamp stamp = Stamp::now();
      std::memcpy(&copies_[i * size_ + high_offset_], &stamp.high, sizeof stamp.high);
      std::memcpy(&copies_[i * size_ + low_offset_], &stamp.low, sizeof stamp.low);
    }
    checked(::send(socket_, copies_.data(), count * size_, 0), "send");
  }

 private:
  int socket_, size_, high_offset_, low_offset_;
  std::vector<uint8_t> copies_;
};

Send samples() {
  const dds_entity_t participant = ros_participant();
  const dds_entity_t topic = checked(
      dds_create_topic(participant, &comms_msg_dds__DrivingBoardMotorMessage__desc, "rt/drive_motor", nullptr, nullptr),
      "dds_create_topic");
  const dds_entity_t writer = checked(dds_create_writer(participant, topic, ros_qos(10), nullptr), "dds_create_writer");
  return [writer](int count) {
    for (int i = 0; i < count; ++i) {
      const Stamp stamp = Stamp::now();
      const comms_msg_dds__DrivingBoardMotorMessage_ sample{stamp.high, stamp.low};
      checked(dds_write(writer, &sample), "dds_write");
    }
  };
}

void sleep_until(int64_t ns) {
  const timespec moment{ns / 1'000'000'000, ns % 1'000'000'000};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &moment, nullptr);
}

int64_t flood(const Send& send, int64_t end) {
  int64_t sent = 0;
  for (; monotonic_ns() < end; sent += batch) send(batch);
  return sent;
}

// A board keeps its pace whatever the bridge's computer does. So a paced load asks for real-time priority, and
// continues
// without it if it is not permitted. A flood gets no more than its share of the processor.
void prefer_this_thread(bool paced) {
  sched_param priority{};
  priority.sched_priority = paced ? 1 : 0;
  sched_setscheduler(0, paced ? SCHED_FIFO : SCHED_OTHER, &priority);
}

// If it is late, it shifts its schedule instead of sending a burst, which would overflow a buffer that the rate does
// not.
int64_t pace(const Send& send, double rate, int64_t start, int64_t end) {
  int64_t sent = 0, next = start;
  for (int64_t tick = 1; tick <= (end - start) / burst_ns; ++tick) {
    const auto due = static_cast<int64_t>(rate * tick * burst_ns / 1e9);
    while (sent < due) {
      const int count = std::min<int64_t>(batch, due - sent);
      send(count);
      sent += count;
    }
    next = std::max(next + burst_ns, monotonic_ns());
    sleep_until(next);
  }
  return sent;
}

int main(int count, char** words) {
  const std::vector<std::string> arguments(words + 1, words + count);
  Send send;
  if (arguments.size() == 5 && arguments[0] == "udp") {
    auto datagrams = std::make_shared<Datagrams>(std::stoi(arguments[1]), bytes_of(arguments[2]),
                                                 std::stoi(arguments[3]), std::stoi(arguments[4]));
    send = [datagrams](int wanted) { datagrams->send(wanted); };
  } else if (arguments.size() == 1 && arguments[0] == "dds") {
    send = samples();
  } else {
    std::cerr << "load udp PORT DATAGRAM_HEX HIGH_OFFSET LOW_OFFSET | load dds\n";
    return 2;
  }
  prctl(PR_SET_TIMERSLACK, 1);
  for (double rate, seconds; std::cin >> rate >> seconds;) {
    prefer_this_thread(rate > 0);
    const int64_t start = monotonic_ns(), end = start + static_cast<int64_t>(seconds * 1e9);
    const int64_t sent = rate > 0 ? pace(send, rate, start, end) : flood(send, end);
    const double lasted = (monotonic_ns() - start) / 1e9;
    std::cout << "{\"sent\": " << sent << ", \"seconds\": " << lasted << "}" << std::endl;
  }
  if (arguments[0] == "dds") dds_delete(DDS_CYCLONEDDS_HANDLE);  // readers then forget this writer immediately
}
