// The way of messages from topics to peers.
#include <sys/eventfd.h>

#include <algorithm>
#include <cerrno>

#include "direct.hpp"
#include "memory.hpp"
#include "outgoing.hpp"
#include "pacing.hpp"
#include "ring.hpp"
#include "roverlink/bridge.h"
#include "shared_counts.hpp"
#include "times.hpp"

namespace roverlink {
namespace {

constexpr uint32_t MOST = 64;        // messages taken at a time; the same numbers as in middleware/serving.py
constexpr uint32_t MOST_BEHIND = 8;  // the same for a topic of low priority: urgent topics wait until these are handled
constexpr int64_t NEVER = INT64_MAX;      // DDS_INFINITY
constexpr int32_t NOTHING_TAKEN = 401;    // RCL_RET_SUBSCRIPTION_TAKE_FAILED
constexpr size_t ROOM = size_t{1} << 20;  // for the datagrams of a batch; longer messages are not converted

void *allocate(size_t size, void *) { return std::malloc(size); }
void deallocate(void *memory, void *) { std::free(memory); }
void *reallocate(void *memory, size_t size, void *) { return std::realloc(memory, size); }
void *zero_allocate(size_t count, size_t size, void *) { return std::calloc(count, size); }

// One call of `rl_serve`.
class Server {
 public:
  explicit Server(rl_server &server)
      : server_(server),
        out_(memory_for<uint8_t>(ROOM)),
        triggered_(memory_for<intptr_t>(2 * size_t{server.n_topics} + 1)),
        direct_(server) {}

  ~Server() { std::free(message_.buffer); }
  Server(const Server &) = delete;
  Server &operator=(const Server &) = delete;

  int run() {
    if (out_ == nullptr || triggered_ == nullptr || !direct_.start()) return -1;
    int ended = 0;
    while (ended == 0 && !load(server_.stopping)) {
      intptr_t *const triggered = triggered_.get();
      const int32_t count = server_.reading.take_one != nullptr ? wait_for_rcl() : wait_for_dds();
      if (count < 0) ended = -1;
      std::sort(triggered, triggered + std::max(count, 0));  // the most urgent first
      if (ended == 0) ended = serve_ready(triggered, triggered + count);
    }
    direct_.stop();
    for (uint32_t index = 0; index < server_.n_topics; ++index)
      if (ended == 0 && direct_.has(index)) ended = serve_held(index);
    return ended;
  }

 private:
  int32_t wait_for_dds() {
    intptr_t *const triggered = triggered_.get();
    const int32_t count = server_.reading.wait(server_.waitset, triggered, server_.n_topics + 1, NEVER);
    intptr_t *end = triggered + std::max(count, 0);
    if (std::find(triggered, end, -1) == end) return count;
    server_.reading.set_guard(server_.wake, false);
    for (uint32_t index = 0; index < server_.n_topics; ++index)
      if (direct_.has(index) && direct_.is_left(index)) *end++ = index;
    return static_cast<int32_t>(end - triggered);
  }

  // As `serve` in middleware/serving.py: before each further topic, all that are more urgent are served again.
  int serve_ready(const intptr_t *first, const intptr_t *last) {
    bool took_time = false;
    for (const intptr_t *ready = first; ready < last; ++ready) {
      if (*ready < 0) continue;
      const auto topic = static_cast<uint32_t>(*ready);
      uint32_t urgent = 0;
      while (server_.priorities[urgent] > server_.priorities[topic]) ++urgent;
      for (uint32_t other = 0; took_time && other < urgent; ++other)
        if (const int ended = serve(other, MOST_BEHIND)) return ended;
      if (const int ended = serve(topic, urgent != 0 ? MOST_BEHIND : MOST)) return ended;
      took_time = true;
    }
    return 0;
  }

  int32_t wait_for_rcl() {
    eventfd_t count;
    while (!is_left_ && eventfd_read(server_.waitset, &count) < 0)
      if (errno != EINTR) return -1;
    is_left_ = false;
    intptr_t *next = triggered_.get();
    for (uint32_t index = 0; index < server_.n_topics; ++index)
      if (__atomic_exchange_n(&server_.topics[index]->arrived, 0, __ATOMIC_ACQ_REL)) *next++ = index;
    return static_cast<int32_t>(next - triggered_.get());
  }

  int serve(uint32_t index, uint32_t most) {
    if (load(server_.stopping)) return 0;
    rl_subscription *topic = server_.topics[index];
    if (server_.reading.take_one != nullptr) return serve_rcl(index, *topic, most);
    const bool is_direct = direct_.has(index);
    if (is_direct) {
      if (!direct_.is_left(index)) return 0;
      if (const int ended = serve_held(index)) return ended;
    } else if (topic == nullptr || !load(topic->native)) {
      return server_.calls.serve(index, most);
    }
    void *samples[MOST] = {};
    rl_sample_info infos[MOST];
    const int32_t count = server_.reading.take(topic->reader, samples, most, infos, EVERYTHING);
    int32_t newest = count - 1;
    while (newest > 0 && !infos[newest].valid_data) --newest;
    int ended = 0;
    for (int32_t one = 0; one < count; ++one) {
      // A sample without valid data says that an instance was disposed; ROS topics have no instances.
      if (ended == 0 && infos[one].valid_data) ended = handle_sample(index, *topic, samples[one], one == newest);
      server_.reading.unref(samples[one]);
    }
    // Python reads again, and raises the error.
    if (count < 0) return server_.calls.serve(index, most);
    if (ended == 0) ended = send(index, *topic);
    if (is_direct && static_cast<uint32_t>(count) == most)
      direct_.wake();
    else if (is_direct)
      direct_.give_back(index);
    return ended;
  }

  // Handles what the thread of Cyclone DDS has taken but could not send.
  int serve_held(uint32_t index) {
    void *samples[DirectTopics::MOST_DIRECT];
    const uint32_t count = direct_.take_held(index, samples);
    int ended = 0;
    for (uint32_t one = 0; one < count; ++one) {
      if (ended == 0) ended = handle_sample(index, *server_.topics[index], samples[one], true);
      server_.reading.unref(samples[one]);
    }
    return ended != 0 ? ended : send(index, *server_.topics[index]);
  }

  int handle_sample(uint32_t index, rl_subscription &topic, const void *sample, bool is_newest) {
    return read_sample(server_.reading, sample, message_) ? handle(index, topic, is_newest) : -1;
  }

  // The same with rcl, which takes one message at a time. It also takes the messages that Python handles: Python would
  // not be told when some are left.
  int serve_rcl(uint32_t index, rl_subscription &topic, uint32_t most) {
    uint32_t taken = 0;
    int32_t code = 0;
    while (taken < most && (code = server_.reading.take_one(topic.subscription, &message_, nullptr, nullptr)) == 0) {
      ++taken;
      if (const int ended = handle(index, topic, true)) return ended;
    }
    if (taken == most) {
      store(topic.arrived, 1u);
      is_left_ = true;
    }
    if (const int ended = send(index, topic)) return ended;
    return code == 0 || code == NOTHING_TAKEN ? 0 : server_.calls.serve(index, most);
  }

  // Converts `message_`, or hands it over.
  int handle(uint32_t index, rl_subscription &topic, bool is_newest) {
    const size_t size = message_.length;
    if (size <= ROOM && load(topic.native)) {
      if (free_ < ROOM / 2 || n_datagrams_ == MOST)
        if (const int ended = send(index, topic)) return ended;
      uint8_t *const end = out_.get() + free_ - (topic.signer != nullptr ? SIGNATURE_ROOM : 0);
      if (uint8_t *const begin =
              write_envelope(server_, topic, server_.workspace, message_, out_.get(), end)) {
        auto made = static_cast<size_t>(end - begin);
        const size_t whole = made;
        if (topic.strips_zeros) made = without_zeros(begin, made);
        const bool is_paced = topic.pacer != nullptr;
        if ((!is_paced || size <= topic.pacer->room) && observe(index, topic, made)) {
          add(topic.taken, 1);
          if (is_paced && !is_newest) {
            add(topic.pacer->superseded, 1);
            return 0;
          }
          const Turn turn = is_paced ? offer(*topic.pacer, message_.buffer, size) : Turn::PASSES;
          if (turn != Turn::PASSES) return turn == Turn::WAITS ? server_.calls.wait(index) : 0;
          is_cut_[n_datagrams_] = made != whole;
          datagrams_[n_datagrams_++] = {begin, made, nullptr, 0};
          free_ = static_cast<size_t>(begin - out_.get());
          return 0;
        }
      }
    }
    if (const int ended = send(index, topic)) return ended;
    const rl_datagram message = {message_.buffer, size, nullptr, 0};
    return server_.calls.take(index, &message);
  }

  // Copies the message to the observers. Returns false if they have no room for it, or for its datagram.
  bool observe(uint32_t index, const rl_subscription &topic, size_t made) {
    const size_t size = message_.length;
    const size_t datagram = (topic.observed & 2) != 0 ? room_of(made) : 0;
    const size_t message = (topic.observed & 1) != 0 ? room_of(size) : 0;
    if (message + datagram == 0) return true;
    if (!has_room(*server_.observers, reserved_ + message + datagram)) return false;
    if (message != 0) put(*server_.observers, 2 * index, monotonic_ns(), message_.buffer, size);
    reserved_ += datagram;  // which is copied when it has been sent
    return true;
  }

  // Sends the datagrams that have been made.
  int send(uint32_t index, rl_subscription &topic) {
    for (uint32_t done = 0; done < n_datagrams_;) {
      const int32_t socket = load(topic.native) ? load(*topic.socket) : -1;
      const uint32_t rest = n_datagrams_ - done;
      const uint32_t sent = topic.signer != nullptr
                                ? send_signed(socket, topic.segments, *topic.signer, datagrams_ + done, rest)
                                : send_all(socket, topic.segments, datagrams_ + done, rest);
      if (sent != 0) store(topic.sent_at, monotonic_ns());
      add(topic.sent, sent);
      for (uint32_t one = done; (topic.observed & 2) != 0 && one < done + sent; ++one)
        put(*server_.observers, (2 * index + 1) | (is_cut_[one] ? RL_RAW : 0), topic.sent_at, datagrams_[one].data,
            datagrams_[one].size);
      done += sent;
      if (done < n_datagrams_)
        if (const int ended = server_.calls.send(index, datagrams_ + done++)) return ended;
    }
    n_datagrams_ = 0;
    free_ = ROOM;
    reserved_ = 0;
    return 0;
  }

  rl_server &server_;
  rl_rcl_message message_ = {nullptr, 0, 0, {allocate, deallocate, reallocate, zero_allocate, nullptr}};
  bool is_left_ = true;  // of rcl: a topic may have messages of which `wake` has told already
  Memory<uint8_t> out_;
  Memory<intptr_t> triggered_;
  DirectTopics direct_;
  rl_datagram datagrams_[MOST] = {};
  bool is_cut_[MOST] = {};  // zeros at the datagram's end were stripped
  uint32_t n_datagrams_ = 0;
  size_t free_ = ROOM;  // bytes of `out_` before the datagrams
  size_t reserved_ = 0;  // bytes of the observers' ring for the datagrams
};

}  // namespace
}  // namespace roverlink

extern "C" {

int rl_serve(rl_server *server) { return roverlink::Server(*server).run(); }

void rl_arrived(const void *subscription, size_t) {
  auto *topic = static_cast<rl_subscription *>(const_cast<void *>(subscription));
  if (__atomic_exchange_n(&topic->arrived, 1, __ATOMIC_ACQ_REL) == 0) eventfd_write(topic->wake, 1);
}

}  // extern "C"
