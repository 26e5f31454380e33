// Contestant `cpp`: the bridge as one would write it by hand in C++ for these two messages, without ROS's layers:
// recvfrom, ParseFromArray, dds_write; and dds_take, SerializeToArray, sendto in the other direction. Its socket buffer
// has the system's default size, like that of the node that it stands for.
//
//   reference LISTEN_PORT A_PORT B_PORT FORWARD     (FORWARD 1: every datagram also goes raw to A and B)
#include "components/common/envelope.pb.h"
#include "cyclone.hpp"
#include "messages.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <iostream>
#include <string>

struct Counts {
  int64_t received = 0, published = 0, forwarded = 0, malformed = 0;
  std::atomic<int64_t> sent{0};  // counted on Cyclone's thread
};

Counts counts;
volatile std::sig_atomic_t stopping = 0;

sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

bool send_raw(int socket, const void* bytes, size_t size, const sockaddr_in& to) {
  return sendto(socket, bytes, size, 0, reinterpret_cast<const sockaddr*>(&to), sizeof to) >= 0;
}

int bound_socket(int port) {
  const int bridge = checked(socket(AF_INET, SOCK_DGRAM, 0), "socket");
  const sockaddr_in at = loopback(port);
  const timeval patience{0, 100'000};  // limits the delay of a SIGINT that comes just before recvfrom
  checked(setsockopt(bridge, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience), "setsockopt");
  checked(bind(bridge, reinterpret_cast<const sockaddr*>(&at), sizeof at), "bind");
  return bridge;
}

dds_entity_t topic(dds_entity_t participant, const dds_topic_descriptor_t& type, const char* name) {
  return checked(dds_create_topic(participant, &type, name, nullptr, nullptr), "dds_create_topic");
}

comms_msg_dds__ImuSensorInformation_ to_ros(const SensorBoardIMUInfo& imu) {
  return {imu.accel_x(),
          imu.accel_y(),
          imu.accel_z(),
          imu.gyro_x(),
          imu.gyro_y(),
          imu.gyro_z(),
          imu.mag_x(),
          imu.mag_y(),
          imu.mag_z(),
          imu.is_calibrated(),
          {static_cast<uint8_t>(imu.state())},
          static_cast<uint8_t>(imu.error_code())};
}

// DDS -> UDP: runs on Cyclone's receiving thread.
struct Outbound {
  int socket;
  sockaddr_in hardware;
};

void on_drive_motor(dds_entity_t reader, void* context) {
  const auto& outbound = *static_cast<const Outbound*>(context);
  comms_msg_dds__DrivingBoardMotorMessage_ sample;
  void* place = &sample;
  dds_sample_info_t info;
  while (checked(dds_take(reader, &place, &info, 1, 1), "dds_take") == 1) {
    if (!info.valid_data) continue;
    PBEnvelope envelope;
    envelope.mutable_drive_motor()->set_distance_to_go(sample.distance_to_go);
    envelope.mutable_drive_motor()->set_turning_radius(sample.turning_radius);
    uint8_t datagram[64];
    const size_t size = envelope.ByteSizeLong();
    envelope.SerializeToArray(datagram, sizeof datagram);
    counts.sent += send_raw(outbound.socket, datagram, size, outbound.hardware);
  }
}

// UDP -> DDS, until SIGINT.
void bridge(int socket, dds_entity_t writer, const sockaddr_in& basestation, const sockaddr_in& hardware,
            bool forward) {
  uint8_t datagram[65536];
  PBEnvelope envelope;
  while (!stopping) {
    const ssize_t size = recvfrom(socket, datagram, sizeof datagram, 0, nullptr, nullptr);
    if (size < 0) continue;  // timeout or signal
    ++counts.received;
    if (forward) {
      counts.forwarded += send_raw(socket, datagram, size, basestation);
      counts.forwarded += send_raw(socket, datagram, size, hardware);
    }
    if (!envelope.ParseFromArray(datagram, size) || !envelope.has_imu_info()) {
      ++counts.malformed;
      continue;
    }
    const auto message = to_ros(envelope.imu_info());
    counts.published += dds_write(writer, &message) == DDS_RETCODE_OK;
  }
}

int main(int count, char** arguments) {
  if (count != 5) {
    std::cerr << "reference LISTEN_PORT A_PORT B_PORT FORWARD\n";
    return 2;
  }
  const sockaddr_in basestation = loopback(std::stoi(arguments[2])), hardware = loopback(std::stoi(arguments[3]));
  const int socket = bound_socket(std::stoi(arguments[1]));

  // Cyclone's threads inherit the blocked signal, so that it interrupts only the receiving loop.
  sigset_t interrupt;
  sigemptyset(&interrupt);
  sigaddset(&interrupt, SIGINT);
  sigprocmask(SIG_BLOCK, &interrupt, nullptr);
  Outbound outbound{socket, hardware};
  dds_listener_t* listener = dds_create_listener(&outbound);
  dds_lset_data_available(listener, on_drive_motor);
  const dds_entity_t participant = ros_participant();
  const dds_entity_t imu_data = topic(participant, comms_msg_dds__ImuSensorInformation__desc, "rt/imu_data");
  const dds_entity_t drive_motor = topic(participant, comms_msg_dds__DrivingBoardMotorMessage__desc, "rt/drive_motor");
  const dds_entity_t writer =
      checked(dds_create_writer(participant, imu_data, ros_qos(10), nullptr), "dds_create_writer");
  checked(dds_create_reader(participant, drive_motor, ros_qos(10), listener), "dds_create_reader");
  struct sigaction stop {};
  stop.sa_handler = [](int) { stopping = 1; };  // without SA_RESTART: recvfrom returns
  sigaction(SIGINT, &stop, nullptr);
  sigprocmask(SIG_UNBLOCK, &interrupt, nullptr);

  bridge(socket, writer, basestation, hardware, std::stoi(arguments[4]) != 0);
  dds_delete(participant);  // others then forget it immediately, not when its lease ends
  std::cout << "{\"received\": " << counts.received << ", \"published\": " << counts.published
            << ", \"forwarded\": " << counts.forwarded << ", \"sent\": " << counts.sent
            << ", \"dropped\": {\"malformed\": " << counts.malformed << "}}" << std::endl;
}
