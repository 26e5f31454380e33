// The way of messages from topics to peers.
#include <sys/eventfd.h>

#include <algorithm>
#include <cerrno>

#include "frame.hpp"
#include "memory.hpp"
#include "pacing.hpp"
#include "roverlink/bridge.h"
#include "ring.hpp"
#include "sending.hpp"
#include "shared_counts.hpp"
#include "signing.hpp"
#include "times.hpp"

namespace roverlink {
namespace {

constexpr uint32_t MOST = 64;        // messages taken at a time; the same numbers as in middleware/serving.py
constexpr uint32_t MOST_BEHIND = 8;  // the same for a topic of low priority: urgent topics wait until these are handled
constexpr uint32_t EVERYTHING = 0x7f;     // DDS_ANY_STATE
constexpr int64_t NEVER = INT64_MAX;      // DDS_INFINITY
constexpr int32_t NOTHING_TAKEN = 401;    // RCL_RET_SUBSCRIPTION_TAKE_FAILED
constexpr size_t ROOM = size_t{1} << 20;  // for the datagrams of a batch; longer messages are not converted
constexpr size_t HEADER = 10;             // bytes of the envelope before the payload, at most

uint8_t *write_varint_before(uint8_t *end, uint64_t value) {
  uint8_t digits[10];
  size_t count = 0;
  do {
    digits[count] = static_cast<uint8_t>((value & 0x7f) | (value > 0x7f ? 0x80 : 0));
    value >>= 7;
    ++count;
  } while (value != 0);
  return std::copy(digits, digits + count, end - count) - count;
}

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
        triggered_(memory_for<intptr_t>(size_t{server.n_topics} + 1)) {}

  ~Server() { std::free(message_.buffer); }
  Server(const Server &) = delete;
  Server &operator=(const Server &) = delete;

  int run() {
    if (out_ == nullptr || triggered_ == nullptr) return -1;
    intptr_t *const triggered = triggered_.get();
    const bool is_rcl = server_.reading.take_one != nullptr;
    while (!load(server_.stopping)) {
      const int32_t count = is_rcl ? wait_for_rcl()
                                   : server_.reading.wait(server_.waitset, triggered, server_.n_topics + 1, NEVER);
      if (count < 0) return -1;
      std::sort(triggered, triggered + count);  // the most urgent first
      if (const int ended = serve_ready(triggered, triggered + count)) return ended;
    }
    return 0;
  }

 private:
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
    if (topic == nullptr || !load(topic->native)) return server_.calls.serve(index, most);
    void *samples[MOST] = {};
    rl_sample_info infos[MOST];
    const int32_t count = server_.reading.take(topic->reader, samples, most, infos, EVERYTHING);
    int32_t newest = count - 1;
    while (newest > 0 && !infos[newest].valid_data) --newest;
    int ended = 0;
    for (int32_t one = 0; one < count; ++one) {
      // A sample without valid data says that an instance was disposed; ROS topics have no instances.
      if (ended == 0 && infos[one].valid_data) ended = read(samples[one]) ? handle(index, *topic, one == newest) : -1;
      server_.reading.unref(samples[one]);
    }
    // Python reads again, and raises the error.
    if (count < 0) return server_.calls.serve(index, most);
    return ended != 0 ? ended : send(index, *topic);
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

  // Copies a sample of Cyclone DDS to `message_`. Returns false if memory is short.
  bool read(const void *sample) {
    const size_t size = server_.reading.size(sample);
    if (size > message_.capacity) {
      void *const longer = std::realloc(message_.buffer, size);
      if (longer == nullptr) return false;
      message_.buffer = static_cast<uint8_t *>(longer);
      message_.capacity = size;
    }
    server_.reading.bytes(sample, 0, size, message_.buffer);
    message_.length = size;
    return true;
  }

  // Converts `message_`, or hands it over.
  int handle(uint32_t index, rl_subscription &topic, bool is_newest) {
    const size_t size = message_.length;
    if (size <= ROOM && load(topic.native)) {
      if (free_ < ROOM / 2 || n_datagrams_ == MOST)
        if (const int ended = send(index, topic)) return ended;
      uint8_t *const end = out_.get() + free_ - (topic.signer != nullptr ? SIGNATURE_ROOM : 0);
      size_t written = static_cast<size_t>(end - out_.get()) - HEADER;
      if (rl_to_proto(server_.table, topic.translation, server_.workspace, message_.buffer, size,
                      out_.get() + HEADER, &written) == RL_OK) {
        uint8_t *begin = write_varint_before(end - written, written);
        begin = write_varint_before(begin, uint64_t{topic.number} << 3 | DELIMITED);
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
