#ifndef ROVERLINK__REASSEMBLY_HPP_
#define ROVERLINK__REASSEMBLY_HPP_

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace roverlink
{

/// All parts of one frame, such as the objects in one camera image.
template<typename Part>
struct Frame
{
  std::uint32_t frame_id = 0;
  /// Parts in the order of their index; empty if the sender reports a frame without parts.
  std::vector<Part> parts;
};

/// What a Reassembler has done with the parts that arrived.
struct ReassemblyCounts
{
  /// Frames that came out.
  std::uint64_t complete = 0;
  /// Frames that were given up. Frames of which no part arrived are not known, and not counted.
  std::uint64_t lost = 0;
  /// Parts of frames that had come out or were passed over.
  std::uint64_t late = 0;
  /// Parts that had arrived already, of a frame that is not complete.
  std::uint64_t duplicates = 0;
  /// Parts whose index does not lie below their total_count.
  std::uint64_t invalid = 0;
  /// Restarts of the sender.
  std::uint64_t restarts = 0;
};

/// Puts the parts of frames together that a sender has divided into several payloads.
///
/// `Part` is a class of protobuf with the fields frame_id, index and total_count. The rules are those of the Python
/// client:
/// - A frame is complete as soon as all its parts have arrived, in any order. Complete frames come out in rising order
///   of their ids. A frame that is not complete when a later one is, is given up: its content is out of date.
/// - The parts of one frame arrive within the timeout. What is not complete by then is given up.
/// - One payload with total_count 0 and index 0 is a frame without parts: the camera saw no object.
/// - A part of a frame that came out or was passed over is late, and ignored. If no other part has arrived during the
///   timeout, it is not late: the sender has started again and counts from the beginning.
///
/// To be used from one thread.
template<typename Part>
class Reassembler
{
public:
  using Clock = std::chrono::steady_clock;

  /// Give up frames that are not complete this long after their first part has arrived.
  explicit Reassembler(Clock::duration timeout = std::chrono::seconds(1)) : timeout_(timeout) {}

  /// Take a part that arrived at `now`, and return its frame if the frame is now complete.
  std::optional<Frame<Part>> add(Part part, Clock::time_point now = Clock::now())
  {
    if (part.index() >= std::max<std::uint32_t>(part.total_count(), 1)) {
      ++counts_.invalid;
      return std::nullopt;
    }
    if (is_late(part.frame_id(), now)) {
      ++counts_.late;
      return std::nullopt;
    }
    heard_ = now;
    give_up([&](const Pending & one) { return now - one.since >= timeout_; });
    Pending & pending = frame_of(part, now);
    counts_.duplicates += pending.parts.count(part.index());
    const std::uint32_t frame_id = part.frame_id(), index = part.index();
    if (part.total_count() != 0) {
      pending.parts.insert_or_assign(index, std::move(part));
    }
    if (pending.parts.size() < pending.total_count) {
      return std::nullopt;
    }
    return completed(frame_id);
  }

  const ReassemblyCounts & counts() const { return counts_; }

private:
  /// Frame whose parts have not all arrived.
  struct Pending
  {
    std::uint32_t frame_id;
    std::uint32_t total_count;
    Clock::time_point since;
    std::map<std::uint32_t, Part> parts;
  };

  /// Enough for all frames that one network delays, and a bound for what a faulty sender can fill.
  static constexpr std::size_t kMostPending = 16;

  /// Return true for a part of the past. If the sender has started again, forget the past.
  bool is_late(std::uint32_t frame_id, Clock::time_point now)
  {
    if (!newest_ || frame_id > *newest_) {
      return false;
    }
    if (now - heard_ < timeout_) {
      return true;
    }
    give_up([](const Pending &) { return true; });
    newest_.reset();
    ++counts_.restarts;
    return false;
  }

  Pending & frame_of(const Part & part, Clock::time_point now)
  {
    const auto found = find(part.frame_id());
    if (found != pending_.end() && found->total_count == part.total_count()) {
      return *found;
    }
    // Two parts that disagree belong to two runs of the sender, or one is faulty: the newer one is right.
    give_up([&](const Pending & one) { return one.frame_id == part.frame_id(); });
    if (pending_.size() >= kMostPending) {
      const std::uint32_t oldest = pending_.front().frame_id;
      give_up([&](const Pending & one) { return one.frame_id == oldest; });
    }
    pending_.push_back({part.frame_id(), part.total_count(), now, {}});
    return pending_.back();
  }

  Frame<Part> completed(std::uint32_t frame_id)
  {
    const auto found = find(frame_id);
    Frame<Part> frame;
    frame.frame_id = frame_id;
    for (auto & [index, part] : found->parts) {
      frame.parts.push_back(std::move(part));
    }
    pending_.erase(found);
    give_up([&](const Pending & one) { return one.frame_id < frame_id; });
    newest_ = frame_id;
    ++counts_.complete;
    return frame;
  }

  typename std::vector<Pending>::iterator find(std::uint32_t frame_id)
  {
    return std::find_if(
      pending_.begin(), pending_.end(), [&](const Pending & one) { return one.frame_id == frame_id; });
  }

  template<typename Condition>
  void give_up(Condition condition)
  {
    const auto first = std::remove_if(pending_.begin(), pending_.end(), condition);
    counts_.lost += static_cast<std::uint64_t>(pending_.end() - first);
    pending_.erase(first, pending_.end());
  }

  Clock::duration timeout_;
  std::vector<Pending> pending_;  // in the order of their first parts
  std::optional<std::uint32_t> newest_;
  Clock::time_point heard_{};
  ReassemblyCounts counts_;
};

}  // namespace roverlink

#endif  // ROVERLINK__REASSEMBLY_HPP_
