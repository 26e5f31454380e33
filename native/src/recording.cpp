// Records of an observers' ring as Message records of MCAP (mcap.dev/spec).
#include "ring.hpp"

namespace roverlink {
namespace {

constexpr uint8_t OPCODE = 5;    // Message
constexpr size_t HEADER = 31;    // opcode, length, channel, sequence, log time and publish time
constexpr size_t UNCOUNTED = 9;  // opcode and length, which the length does not count

// Calls `visit` with the channel in the file, the record and its data, for each record that the file gets.
template <typename Visit>
void each(const rl_recording &recording, Visit visit) {
  Record record;
  for (size_t place = 0; place < recording.size; place += room_of(record.size)) {
    std::memcpy(&record, recording.records + place, sizeof record);
    const uint16_t channel = recording.channels[record.channel & ~RL_RAW];
    const bool is_raw = (record.channel & RL_RAW) != 0;
    if (channel != 0)
      visit(static_cast<uint16_t>(channel + is_raw), record, recording.records + place + sizeof record);
  }
}

rl_run *run_of(rl_run *first, rl_run *last, uint16_t channel) {
  return std::find_if(first, last, [channel](const rl_run &run) { return run.channel == channel; });
}

template <typename T>
uint8_t *write(uint8_t *out, T value) {
  std::memcpy(out, &value, sizeof value);
  return out + sizeof value;
}

}  // namespace
}  // namespace roverlink

extern "C" {

uint32_t rl_count_records(const rl_recording *recording, rl_run *runs) {
  rl_run *last = runs;
  roverlink::each(*recording, [&](uint16_t channel, const roverlink::Record &, const uint8_t *) {
    rl_run *const run = roverlink::run_of(runs, last, channel);
    if (run == last) *last++ = {channel, 0, 0};
    ++run->count;
  });
  return static_cast<uint32_t>(last - runs);
}

size_t rl_record(const rl_recording *recording, rl_run *runs, uint32_t n_runs, uint64_t offset, uint8_t *out,
                 uint64_t *index) {
  using namespace roverlink;
  for (uint32_t run = 1; run < n_runs; ++run) runs[run].first = runs[run - 1].first + runs[run - 1].count;
  uint8_t *at = out;
  each(*recording, [&](uint16_t channel, const Record &record, const uint8_t *data) {
    const auto time = static_cast<uint64_t>(record.at + recording->log_time);
    uint64_t *const entry = index + 2 * run_of(runs, runs + n_runs, channel)->first++;
    entry[0] = time;
    entry[1] = offset + static_cast<uint64_t>(at - out);
    at = write(at, OPCODE);
    at = write(at, uint64_t{HEADER - UNCOUNTED + record.size});
    at = write(at, channel);
    at = write(at, uint32_t{0});
    at = write(at, time);
    at = write(at, static_cast<uint64_t>(record.at + recording->publish_time));
    at = std::copy(data, data + record.size, at);
  });
  return static_cast<size_t>(at - out);
}

}  // extern "C"
