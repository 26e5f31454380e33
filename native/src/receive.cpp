// The way of datagrams from the socket to topics and other peers.
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cmath>

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

constexpr size_t MESSAGE_ROOM = size_t{1} << 20;  // for the messages of one datagram on all topics of its row, and those that are kept
constexpr int64_t LOOK_NS = 2'000'000'000;
constexpr int64_t PAUSE = 9;  // a publisher that made the thread wait is left alone for so many times as long
constexpr timeval PATIENCE = {0, 50'000};  // of a read, which does not see `wake`
constexpr int SDK_DATA = 2;   // enum ddsi_serdata_kind

constexpr size_t SENDERS = 256;  // whose admission is remembered
constexpr size_t ADMITTED = 8;   // words of 64 bits, each bit for a row

// Sender from which some rows were admitted.
struct Sender {
  uint8_t address[28];      // struct sockaddr_in or sockaddr_in6
  uint32_t size;            // bytes of the address; 0 for none
  uint64_t rows[ADMITTED];  // bit by index of the row
  rl_bucket *bucket;
};

struct Reading {
  mmsghdr headers[RL_SLOTS];
  iovec places[RL_SLOTS];
  sockaddr_storage senders[RL_SLOTS];
  rl_datagram datagrams[RL_SLOTS];
};

bool varint(const uint8_t *&at, const uint8_t *end, uint32_t *value) {
  uint64_t found = 0;
  for (unsigned shift = 0; shift < 35 && at < end; shift += 7) {
    const uint8_t byte = *at++;
    found |= uint64_t{byte & 0x7fu} << shift;
    if (byte < 0x80) {
      *value = static_cast<uint32_t>(found);
      return found <= UINT32_MAX;
    }
  }
  return false;
}

// One call of `rl_receive`.
class Loop {
 public:
  explicit Loop(rl_bridge &bridge)
      : bridge_(bridge),
        stride_(size_t{bridge.largest} + SIGNATURE_ROOM),
        signature_size_(size_of_signature(bridge.signature)),
        bytes_(memory_for<uint8_t>(stride_ * RL_SLOTS)),
        messages_(memory_for<uint8_t>(MESSAGE_ROOM)),
        reading_(memory_for<Reading>(1)) {}

  int run() {
    if (bytes_ == nullptr || messages_ == nullptr || reading_ == nullptr) return -1;
    for (size_t slot = 0; slot < RL_SLOTS; ++slot) prepare(slot);
    setsockopt(bridge_.socket, SOL_SOCKET, SO_RCVTIMEO, &PATIENCE, sizeof PATIENCE);
    pollfd watched[2] = {{bridge_.socket, POLLIN, 0}, {bridge_.wake, POLLIN, 0}};
    while (!load(bridge_.stopping)) {
      // Level-triggered: it returns at once if data is left, so no datagram can be forgotten.
      poll(watched, 2, -1);
      if (watched[1].revents != 0) return 0;
      // While datagrams come, the read itself waits for the next one, which saves a system call for each.
      while (uint32_t count = read())
        if (const int ended = handle_all(count)) return ended;
    }
    return 0;
  }

 private:
  // Datagrams of a burst that are handed over, and what has been done for the others.
  struct Burst {
    rl_datagram handed_over[RL_BURST];
    uint32_t handed_over_rows[RL_BURST];
    uint32_t n_handed_over = 0;
    bool is_urgent = false;  // no later datagram may be handled before those that are handed over
    uint64_t forward[RL_BURST] = {};
    const rl_row *rows[RL_BURST] = {};
    size_t sizes[RL_BURST] = {};  // of the envelopes to forward: a datagram may have more or fewer zeros at its end
    const rl_datagram *datagrams;
    uint32_t size;
    timespec arrived;
  };

  int handle_all(uint32_t count) {
    for (uint32_t first = 0; first < count; first += RL_BURST) {
      const uint32_t size = std::min<uint32_t>(RL_BURST, count - first);
      if (const int ended = handle(reading_[0].datagrams + first, size)) return ended;
    }
    return 0;
  }

  void prepare(size_t slot) {
    Reading &reading = reading_[0];
    reading.places[slot] = {bytes_.get() + slot * stride_, bridge_.largest};
    msghdr &header = reading.headers[slot].msg_hdr;
    header = {};
    header.msg_name = &reading.senders[slot];
    header.msg_namelen = sizeof reading.senders[slot];
    header.msg_iov = &reading.places[slot];
    header.msg_iovlen = 1;
  }

  // Waits for datagrams, and returns the number of those that have arrived; 0 if none came for a while.
  uint32_t read() {
    if (load(bridge_.stopping)) return 0;
    Reading &reading = reading_[0];
    const int count = recvmmsg(bridge_.socket, reading.headers, RL_SLOTS, MSG_WAITFORONE, nullptr);
    for (int slot = 0; slot < count; ++slot) {
      msghdr &header = reading.headers[slot].msg_hdr;
      reading.datagrams[slot] = {bytes_.get() + static_cast<size_t>(slot) * stride_, reading.headers[slot].msg_len,
                                 header.msg_name, header.msg_namelen};
      header.msg_namelen = sizeof reading.senders[slot];
    }
    return count > 0 ? static_cast<uint32_t>(count) : 0;
  }

  int handle(const rl_datagram *datagrams, uint32_t size) {
    began_ = monotonic_ns();
    Burst burst;
    burst.datagrams = datagrams;
    burst.size = size;
    clock_gettime(CLOCK_REALTIME, &burst.arrived);
    // The seconds of builtin_interfaces/Time have 32 bits; Python says what is done beyond.
    const bool native = burst.arrived.tv_sec >= 0 && burst.arrived.tv_sec <= INT32_MAX;
    for (uint32_t index = 0; index < size; ++index) {
      rl_row *row = native ? row_of(datagrams[index]) : nullptr;
      if (burst.is_urgent && row != nullptr && load(row->native))
        if (const int ended = settle(burst)) return ended;
      if (row == nullptr || !publish(*row, datagrams[index], burst)) {
        burst.handed_over_rows[burst.n_handed_over] = row != nullptr ? row->number : 0;
        burst.handed_over[burst.n_handed_over++] = datagrams[index];
        // The order counts for the timestamps of a key, and for the rate of a sender.
        burst.is_urgent |= bridge_.is_ordered || (row != nullptr && row->at_once);
        continue;
      }
      burst.forward[index] = row->forward;
      burst.rows[index] = row;
      burst.sizes[index] = envelope_size_;
      add(row->handled, 1);
      ++handled_;
    }
    if (const int ended = settle(burst)) return ended;
    if (const int ended = tell()) return ended;
    if (began_ < next_tick_) return 0;
    next_tick_ = began_ + LOOK_NS;
    return bridge_.calls.handle(nullptr, 0);
  }

  // The row of a datagram that is an envelope with one payload, and a signature if the row needs one; else null.
  rl_row *row_of(const rl_datagram &datagram) {
    if (datagram.size >= bridge_.largest) return nullptr;  // it may have been longer
    if (rl_row *const row = row_of(datagram.data, datagram.size)) return row;
    // Only bytes behind the datagram change, so that Python can still get it as it came.
    auto *const data = const_cast<uint8_t *>(datagram.data);
    const size_t size = roverlink_restore(data, datagram.size, bridge_.largest);
    return size != datagram.size ? row_of(data, size) : nullptr;
  }

  rl_row *row_of(const uint8_t *data, size_t envelope_size) {
    const uint8_t *at = data, *const end = data + envelope_size;
    uint32_t tag = 0, size = 0;
    if (!varint(at, end, &tag) || (tag & 7) != DELIMITED) return nullptr;
    rl_row *const last = bridge_.rows + bridge_.n_rows;
    rl_row *row = std::lower_bound(bridge_.rows, last, tag >> 3,
                                   [](const rl_row &one, uint32_t number) { return one.number < number; });
    if (row == last || row->number != tag >> 3) return nullptr;
    if (!varint(at, end, &size) || size > static_cast<size_t>(end - at)) return nullptr;
    payload_ = at;
    payload_size_ = size;
    envelope_ = data;
    envelope_size_ = envelope_size;
    at += size;
    if (!row->is_signed) return at == end ? row : nullptr;
    if (static_cast<size_t>(end - at) != signature_size_ || !varint(at, end, &tag)) return nullptr;
    const bool is_signature = tag == (bridge_.signature << 3 | DELIMITED) && *at == SIGNATURE;
    return is_signature && end - at == 1 + SIGNATURE ? row : nullptr;
  }

  // The key that has signed the envelope for a row; null if Python has to judge it.
  rl_stream *stream_of(const rl_row &row) const {
    const uint8_t id = envelope_[envelope_size_ - SIGNATURE];
    if ((row.signers[id / 64] >> id % 64 & 1) == 0) return nullptr;
    rl_stream *const *const last = bridge_.streams + bridge_.n_streams;
    rl_stream *const *const found =
        std::find_if(bridge_.streams, last, [id](const rl_stream *one) { return one->key.id == id; });
    if (found == last) return nullptr;
    const uint64_t timestamp = roverlink_timestamp(envelope_, envelope_size_);
    if (timestamp <= (*found)->key.last || timestamp > (*found)->plausible) return nullptr;
    return roverlink_is_authentic(&(*found)->key, envelope_, envelope_size_) ? *found : nullptr;
  }

  void accept(rl_stream &stream) const {
    const uint64_t timestamp = roverlink_timestamp(envelope_, envelope_size_);
    if (timestamp > load(stream.clock->now.last)) hear(*stream.clock, timestamp);
    store(stream.key.last, timestamp);
  }

  // Publishes the payload on all topics of its row. Returns false, without having published anything, if the datagram
  // has to be handed over.
  bool publish(const rl_row &row, const rl_datagram &datagram, const Burst &burst) {
    if (!load(row.native) || (envelope_size_ > row.longest && !load(bridge_.forwards_all))) return false;
    bucket_ = nullptr;
    if (load(bridge_.checks_senders) && !is_admitted(row, datagram)) return false;
    rl_stream *const stream = row.is_signed ? stream_of(row) : nullptr;
    if (row.is_signed && stream == nullptr) return false;
    // The messages of a topic keep their order.
    const uint32_t *const others = burst.handed_over_rows, *const end = others + burst.n_handed_over;
    if (std::find(others, end, row.number) != end) return false;
    size_t used = kept_, observed = bridge_.observed ? room_of(datagram.size) : 0;
    uint64_t to_write = 0;
    for (uint32_t index = 0; index < row.topics; ++index) {
      const rl_topic &topic = bridge_.topics[row.first_topic + index];
      const bool is_wanted = wanted(topic);
      sizes_[index] = 0;
      // The row's own message is translated in any case: a value that does not fit is told.
      if (index != 0 && !is_wanted && !topic.observed) continue;
      size_t size = MESSAGE_ROOM - used;
      if (size < 8) return false;
      if (rl_to_cdr(bridge_.table, topic.translation, bridge_.workspace, payload_, payload_size_,
                    static_cast<int32_t>(burst.arrived.tv_sec), static_cast<uint32_t>(burst.arrived.tv_nsec),
                    messages_.get() + used, &size) != RL_OK)
        return false;
      if (topic.pacer != nullptr && size > topic.pacer->room) return false;
      sizes_[index] = size;
      used += (size + 7) & ~size_t{7};
      if (is_wanted) to_write |= uint64_t{1} << index;
      if (topic.observed) observed += room_of(size);
    }
    if (observed != 0 && !has_room(*bridge_.observers, reserved_ + observed)) return false;
    if (stream != nullptr) accept(*stream);
    if (bucket_ != nullptr) bucket_->allowance -= 1;
    const int64_t now = observed != 0 ? monotonic_ns() : 0;
    if (bridge_.observed) {
      const uint32_t channel = bridge_.n_topics | (envelope_size_ == datagram.size ? 0 : RL_RAW);
      put(*bridge_.observers, channel, now, datagram.data, datagram.size);
    }
    used = kept_;
    for (uint32_t index = 0; index < row.topics; ++index) {
      const size_t size = sizes_[index];
      if (size == 0) continue;
      const Made made = {row.first_topic + index, messages_.get() + used, size, (to_write >> index & 1) != 0};
      used += (size + 7) & ~size_t{7};
      if (bridge_.topics[made.topic].pacer != nullptr) {
        keep(made);
        kept_ = used;
      } else {
        pass(made, now);
      }
    }
    return true;
  }

  // Serialized message for a topic.
  struct Made {
    uint32_t topic;
    uint8_t *message;
    size_t size;
    bool is_wanted;
  };

  void pass(const Made &made, int64_t now) {
    rl_topic &topic = bridge_.topics[made.topic];
    if (made.is_wanted && !write(topic, made.message, made.size)) {
      note_unpublished(made.topic);
      return;
    }
    add(topic.published, 1);
    store(topic.published_at, began_);
    if (topic.observed) put(*bridge_.observers, made.topic, now, made.message, made.size);
  }

  // Of the messages of a burst for a topic with a limit, the newest one takes the turn, as in PacedInboundRow.
  void keep(const Made &made) {
    const rl_topic &topic = bridge_.topics[made.topic];
    if (topic.observed) reserved_ += room_of(made.size);
    Made *const place = std::find_if(paced_, paced_ + n_paced_, [&](const Made &one) { return one.topic == made.topic; });
    if (place != paced_ + n_paced_)
      add(topic.pacer->superseded, 1);
    else
      ++n_paced_;
    *place = made;
  }

  void offer_kept() {
    for (const Made *made = paced_; made != paced_ + n_paced_; ++made) {
      const Turn turn = offer(*bridge_.topics[made->topic].pacer, made->message, made->size);
      if (turn == Turn::PASSES) pass(*made, monotonic_ns());
      // Python publishes it, or a newer one.
      if (turn == Turn::WAITS && n_waiting_ < RL_BURST) waiting_[n_waiting_++] = made->topic;
    }
    n_paced_ = 0;
    kept_ = reserved_ = 0;
  }

  // Python has decided once that the row may come from the sender, and learns nothing from another datagram.
  bool is_admitted(const rl_row &row, const rl_datagram &datagram) {
    bucket_ = bucket_of(row, datagram);
    if (bucket_ == nullptr || bucket_->rate == HUGE_VAL) return bucket_ != nullptr;
    // Python may have taken a token after the burst began.
    const double now = std::max(bucket_->at, static_cast<double>(began_) * 1e-9);
    bucket_->allowance = std::min(bucket_->burst, bucket_->allowance + (now - bucket_->at) * bucket_->rate);
    bucket_->at = now;
    return bucket_->allowance >= 1;
  }

  rl_bucket *bucket_of(const rl_row &row, const rl_datagram &datagram) {
    const auto index = static_cast<uint32_t>(&row - bridge_.rows);
    if (datagram.sender == nullptr || datagram.sender_size > sizeof(Sender::address)) return nullptr;
    if (index >= ADMITTED * 64) return nullptr;
    if (const uint32_t now = load(bridge_.senders); now != senders_as_of_) {
      std::fill(senders_, senders_ + SENDERS, Sender{});
      senders_as_of_ = now;
    }
    Sender &sender = senders_[place_of(datagram)];
    const bool is_known = sender.size == datagram.sender_size &&
                          std::memcmp(sender.address, datagram.sender, datagram.sender_size) == 0;
    const uint64_t bit = uint64_t{1} << index % 64;
    if (is_known && (sender.rows[index / 64] & bit) != 0) return sender.bucket;
    rl_bucket *const bucket = bridge_.calls.admit(index, &datagram);
    if (bucket == nullptr) return nullptr;
    if (!is_known) {
      sender = {};
      sender.size = static_cast<uint32_t>(datagram.sender_size);
      std::memcpy(sender.address, datagram.sender, datagram.sender_size);
    }
    sender.rows[index / 64] |= bit;
    return sender.bucket = bucket;
  }

  static size_t place_of(const rl_datagram &datagram) {
    uint32_t hash = 2166136261u;  // FNV-1a
    for (size_t one = 0; one < datagram.sender_size; ++one)
      hash = (hash ^ static_cast<const uint8_t *>(datagram.sender)[one]) * 16777619u;
    return (hash ^ hash >> 16) % SENDERS;
  }

  bool wanted(const rl_topic &topic) const {
    if (load(topic.wanted)) return true;
    if (topic.publisher == nullptr) return false;
    size_t count = 0;
    return bridge_.middleware.count_subscriptions(topic.publisher, &count) == 0 && count > 0;
  }

  // Publishes a serialized message; the bytes behind it, up to a multiple of eight, may be changed.
  bool write(rl_topic &topic, uint8_t *message, size_t size) {
    if (topic.publisher == nullptr) {
      const size_t whole = (size + 3) & ~size_t{3};  // Cyclone DDS takes multiples of four
      std::fill(message + size, message + whole, uint8_t{0});
      const iovec place = {message, whole};
      void *serdata = bridge_.middleware.serdata(topic.sertype, SDK_DATA, 1, &place, whole);
      if (serdata == nullptr) return false;
      note_touched(topic.writer);
      return bridge_.middleware.write(topic.writer, serdata) == 0;
    }
    const int64_t began = monotonic_ns();
    if (began < topic.paused_until) return false;
    rl_rcl_message serialized = {message, size, size, {}};
    if (bridge_.middleware.publish(topic.publisher, &serialized, nullptr) == 0) return true;
    const int64_t now = monotonic_ns();
    topic.paused_until = now + PAUSE * (now - began);
    return false;
  }

  // Cyclone DDS collects what is written, and sends one packet for the whole burst.
  void note_touched(int32_t writer) {
    if (std::find(touched_, touched_ + n_touched_, writer) != touched_ + n_touched_) return;
    touched_[n_touched_++] = writer;
  }

  void flush() {
    for (uint32_t index = 0; index < n_touched_; ++index) bridge_.middleware.flush(touched_[index]);
    n_touched_ = 0;
  }

  void note_unpublished(uint32_t topic) {
    unpublished_[n_unpublished_++] = topic;
  }

  int tell() {
    for (uint32_t index = 0; index < n_unpublished_; ++index)
      if (const int ended = bridge_.calls.not_published(unpublished_[index])) return ended;
    n_unpublished_ = 0;
    for (uint32_t index = 0; index < n_waiting_; ++index)
      if (const int ended = bridge_.calls.wait(waiting_[index])) return ended;
    n_waiting_ = 0;
    return 0;
  }

  // Finishes what has been done for the datagrams so far, and hands the others over.
  int settle(Burst &burst) {
    offer_kept();
    flush();
    if (const int ended = forward(burst)) return ended;
    if (handled_ != 0) note_latency();
    const uint32_t count = burst.n_handed_over;
    burst.n_handed_over = 0;
    burst.is_urgent = false;
    return count != 0 ? bridge_.calls.handle(burst.handed_over, count) : 0;
  }

  int forward(Burst &burst) {
    const bool as_they_are = load(bridge_.forwards_all);
    for (uint32_t index = 0; index < bridge_.n_destinations; ++index) {
      rl_destination &destination = bridge_.destinations[index];
      const rl_signer *const signer = as_they_are ? nullptr : destination.signer;
      rl_datagram chosen[RL_BURST];
      uint32_t count = 0;
      for (uint32_t other = 0; other < burst.size; ++other) {
        if (burst.sizes[other] == 0 || !(as_they_are || (burst.forward[other] >> index & 1))) continue;
        chosen[count] = burst.datagrams[other];
        if (!as_they_are) chosen[count].size = burst.sizes[other];
        rl_pacer *const *const pacers = as_they_are ? nullptr : burst.rows[other]->forward_pacers;
        const Turn turn = pacers == nullptr || pacers[index] == nullptr
                              ? Turn::PASSES
                              : offer(*pacers[index], chosen[count].data, chosen[count].size);
        if (turn == Turn::WAITS && n_waiting_ < RL_BURST) waiting_[n_waiting_++] = burst.rows[other]->first_topic;
        count += turn == Turn::PASSES;
      }
      for (uint32_t done = 0; done < count;) {
        const int socket = load(*destination.socket);
        const uint32_t sent = signer != nullptr
                                  ? send_signed(socket, destination.segments, *signer, chosen + done, count - done)
                                  : send_all(socket, destination.segments, chosen + done, count - done);
        add(destination.forwarded, sent);
        done += sent;
        // Python tries to send what could not be sent, and says why.
        if (done < count)
          if (const int ended = bridge_.calls.send(index, chosen + done++, 1)) return ended;
      }
    }
    std::fill(burst.sizes, burst.sizes + burst.size, size_t{0});
    return 0;
  }

  void note_latency() {
    const double took = static_cast<double>(monotonic_ns() - began_) * 1e-9;
    const auto bucket = std::lower_bound(bridge_.bounds, bridge_.bounds + bridge_.n_bounds, took) - bridge_.bounds;
    add(bridge_.latencies[bucket], handled_);
    bridge_.latency_sum += took * static_cast<double>(handled_);
    add(bridge_.received, handled_);
    handled_ = 0;
  }

  static constexpr uint32_t TOPICS = 64;                 // of one row, at most
  static constexpr uint32_t WRITES = RL_BURST * TOPICS;  // of one burst, at most

  rl_bridge &bridge_;
  const size_t stride_;          // bytes of a slot, with room for a signature
  const size_t signature_size_;  // bytes of the signature's field
  Memory<uint8_t> bytes_, messages_;
  Memory<Reading> reading_;
  const uint8_t *payload_ = nullptr, *envelope_ = nullptr;
  size_t payload_size_ = 0, envelope_size_ = 0;
  size_t sizes_[TOPICS] = {};
  int32_t touched_[WRITES] = {};
  uint32_t n_touched_ = 0;
  uint32_t unpublished_[WRITES] = {};
  uint32_t n_unpublished_ = 0;
  Made paced_[RL_BURST] = {};  // of a row, only its own topic has a pacer
  uint32_t n_paced_ = 0;
  size_t kept_ = 0;      // bytes of `messages_` up to the end of those in `paced_`
  size_t reserved_ = 0;  // bytes of the observers' ring for them
  uint32_t waiting_[RL_BURST] = {};  // whose row has a message or a datagram that waits: one call wakes Python
  uint32_t n_waiting_ = 0;
  rl_bucket *bucket_ = nullptr;  // of the sender of the datagram
  Sender senders_[SENDERS] = {};
  uint32_t senders_as_of_ = 0;
  uint64_t handled_ = 0;
  int64_t began_ = 0;  // of the burst, on the monotonic clock
  int64_t next_tick_ = 0;
};

}  // namespace
}  // namespace roverlink

extern "C" {

int rl_check_bridge(const rl_bridge *bridge) {
  if (bridge->n_bounds >= RL_BUCKETS || bridge->n_destinations > 64) return RL_WRONG_TABLE;
  for (uint32_t index = 0; index < bridge->n_topics; ++index)
    if (bridge->topics[index].translation >= bridge->table->n_translations) return RL_WRONG_TABLE;
  for (uint32_t index = 0; index < bridge->n_rows; ++index) {
    const rl_row &row = bridge->rows[index];
    if (row.topics > 64 || row.first_topic > bridge->n_topics || row.topics > bridge->n_topics - row.first_topic)
      return RL_WRONG_TABLE;
    if (bridge->n_destinations < 64 && row.forward >> bridge->n_destinations != 0) return RL_WRONG_TABLE;
  }
  return RL_OK;
}

int rl_receive(rl_bridge *bridge) { return roverlink::Loop(*bridge).run(); }

}  // extern "C"
