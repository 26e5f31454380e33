// Topics whose single messages are sent on the thread of Cyclone DDS that has received them.
//
// This spares the wake-up of another thread for each message. That thread of Cyclone DDS receives for the whole process,
// so it never waits for Python. In a burst, or if a message cannot be converted or sent, the topic is left to the server's
// thread, until that has handled all of its messages: it takes batches, in the order of priorities.
#pragma once

#include <algorithm>
#include <utility>

#include "lock.hpp"
#include "memory.hpp"
#include "outgoing.hpp"
#include "shared_counts.hpp"
#include "times.hpp"

namespace roverlink {

class DirectTopics {
 public:
  // The server has to stay where it is.
  explicit DirectTopics(rl_server &server)
      : server_(server), topics_(memory_for<Topic>(server.n_topics)), room_(memory_for<uint8_t>(ROOM)) {}

  ~DirectTopics() { std::free(message_.buffer); }
  DirectTopics(const DirectTopics &) = delete;
  DirectTopics &operator=(const DirectTopics &) = delete;

  // Begins to serve, with all topics left to the server's thread. Returns false if memory is short.
  bool start() {
    if (topics_ == nullptr || room_ == nullptr) return false;
    for (uint32_t index = 0; index < server_.n_topics; ++index) {
      Topic &topic = topics_[index] = {this, server_.topics[index], 1, 0, {}, 0};
      if (!has(index)) continue;
      void *const listener = server_.reading.new_listener(&topic);
      server_.reading.on_data_available(listener, available);
      server_.reading.set_listener(topic.subscription->reader, listener);
      server_.reading.delete_listener(listener);
      wake();
    }
    return true;
  }

  // Ends the service: afterwards, no thread of Cyclone DDS is in this class.
  void stop() {
    for (uint32_t index = 0; index < server_.n_topics; ++index)
      if (has(index)) server_.reading.set_listener(topics_[index].subscription->reader, nullptr);
  }

  bool has(uint32_t index) const { return server_.topics[index] != nullptr && server_.topics[index]->is_direct != 0; }

  bool is_left(uint32_t index) {
    const Locked locked(lock_);
    return topics_[index].is_left != 0;
  }

  // Gives the samples that were taken but not sent, the oldest first; at most MOST_DIRECT. The caller releases them.
  uint32_t take_held(uint32_t index, void **samples) {
    const Locked locked(lock_);
    Topic &topic = topics_[index];
    std::copy(topic.held, topic.held + topic.n_held, samples);
    return std::exchange(topic.n_held, 0);
  }

  // Ends that a topic is left to the server's thread, which has handled all messages that it saw.
  void give_back(uint32_t index) {
    const Locked locked(lock_);
    topics_[index].is_left = 0;
    send_now(topics_[index]);  // what came meanwhile
  }

  // Lets the server's thread look for topics that are left to it.
  void wake() { server_.reading.set_guard(server_.wake, true); }

  static constexpr uint32_t MOST_DIRECT = 4;

 private:
  static constexpr int64_t BURST_NS = 100'000;  // between messages of a burst, at most
  static constexpr size_t ROOM = size_t{1} << 17;  // for a datagram, which has at most 65,507 bytes

  struct Topic {
    DirectTopics *all;
    rl_subscription *subscription;
    uint32_t is_left;
    int64_t arrived;  // time of the last message
    void *held[MOST_DIRECT];
    uint32_t n_held;
  };

  static void available(int32_t, void *argument) {
    auto &topic = *static_cast<Topic *>(argument);
    topic.all->arrive(topic);
  }

  void arrive(Topic &topic) {
    const Locked locked(lock_);
    if (topic.is_left != 0) return;
    const int64_t now = monotonic_ns();
    const bool is_burst = now - topic.arrived < BURST_NS;
    topic.arrived = now;
    if (is_burst)
      leave_to_server(topic);
    else
      send_now(topic);
  }

  void leave_to_server(Topic &topic) {
    topic.is_left = 1;
    wake();
  }

  void send_now(Topic &topic) {
    void *samples[MOST_DIRECT] = {};
    rl_sample_info infos[MOST_DIRECT];
    const int32_t count = server_.reading.take(topic.subscription->reader, samples, MOST_DIRECT, infos, EVERYTHING);
    for (int32_t one = 0; one < count; ++one) {
      if (infos[one].valid_data && (topic.n_held != 0 || !send(*topic.subscription, samples[one])))
        topic.held[topic.n_held++] = samples[one];
      else
        server_.reading.unref(samples[one]);
    }
    if (count < 0 || count == MOST_DIRECT || topic.n_held != 0) leave_to_server(topic);
  }

  bool send(rl_subscription &topic, const void *sample) {
    if (!load(topic.native) || !read_sample(server_.reading, sample, message_)) return false;
    uint8_t *const end = room_.get() + ROOM;
    const uint8_t *const begin = write_envelope(server_, topic, server_.direct_workspace, message_, room_.get(), end);
    if (begin == nullptr) return false;
    auto size = static_cast<size_t>(end - begin);
    if (topic.strips_zeros) size = without_zeros(begin, size);
    const rl_datagram datagram = {begin, size, nullptr, 0};
    if (send_all(load(*topic.socket), false, &datagram, 1) == 0) return false;
    store(topic.sent_at, monotonic_ns());
    add(topic.taken, 1);
    add(topic.sent, 1);
    return true;
  }

  rl_server &server_;
  Memory<Topic> topics_;
  Memory<uint8_t> room_;
  rl_rcl_message message_ = {};
  rl_lock lock_ = {};  // of all members
};

}  // namespace roverlink
