// Sending of datagrams to a connected UDP socket.
#pragma once

#include <netinet/in.h>
#include <netinet/udp.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "roverlink/bridge.h"

#ifndef UDP_SEGMENT
#define UDP_SEGMENT 103  // linux/udp.h
#endif

namespace roverlink {

constexpr uint32_t MOST_TOGETHER = 64;  // UDP_MAX_SEGMENTS of Linux up to 6.8

// Sends datagrams of one size with one system call, which the kernel cuts apart (UDP_SEGMENT, udp(7)). Returns false if
// this failed; then none of them was sent.
inline bool send_as_one(int socket, const rl_datagram *datagrams, uint32_t count) {
  iovec places[MOST_TOGETHER];
  for (uint32_t one = 0; one < count; ++one)
    places[one] = {const_cast<uint8_t *>(datagrams[one].data), datagrams[one].size};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(uint16_t))] = {};
  msghdr message = {};
  message.msg_iov = places;
  message.msg_iovlen = count;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  cmsghdr *header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = IPPROTO_UDP;
  header->cmsg_type = UDP_SEGMENT;
  header->cmsg_len = CMSG_LEN(sizeof(uint16_t));
  const auto size = static_cast<uint16_t>(datagrams[0].size);
  std::memcpy(CMSG_DATA(header), &size, sizeof size);
  return sendmsg(socket, &message, 0) >= 0;
}

inline bool send_one(int socket, const rl_datagram &datagram) {
  if (::send(socket, datagram.data, datagram.size, 0) >= 0) return true;
  // ECONNREFUSED is that of an earlier datagram: nobody listened. This one has not been sent yet.
  return errno == ECONNREFUSED && ::send(socket, datagram.data, datagram.size, 0) >= 0;
}

// Sends datagrams in order. Returns how many were sent, up to the first that could not be sent.
inline uint32_t send_all(int socket, bool segments, const rl_datagram *datagrams, uint32_t count) {
  if (socket < 0) return 0;
  uint32_t sent = 0;
  while (sent < count) {
    uint32_t last = sent + 1;
    // The size of a segment has 16 bits, and all segments are one datagram to the kernel: 65,507 bytes at most.
    const size_t size = datagrams[sent].size;
    while (last < count && last - sent < MOST_TOGETHER && datagrams[last].size == size) ++last;
    const bool fits = size != 0 && size * (last - sent) <= 65'507;
    if (last - sent > 1 && segments && fits && send_as_one(socket, datagrams + sent, last - sent)) {
      sent = last;
      continue;
    }
    for (; sent < last; ++sent)
      if (!send_one(socket, datagrams[sent])) return sent;
  }
  return sent;
}

}  // namespace roverlink
