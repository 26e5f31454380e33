#include <roverlink/reassembly.hpp>

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace
{

/// Part with the accessors of a class of protobuf.
struct Part
{
  std::uint32_t frame, place, count;
  std::uint32_t frame_id() const { return frame; }
  std::uint32_t index() const { return place; }
  std::uint32_t total_count() const { return count; }
};

using Reassembler = roverlink::Reassembler<Part>;

std::string text_of(const std::optional<roverlink::Frame<Part>> & frame)
{
  return frame ? std::to_string(frame->frame_id) + ":" + std::to_string(frame->parts.size()) : "-";
}

std::string text_of(const roverlink::ReassemblyCounts & counts)
{
  std::ostringstream text;
  text << counts.complete << '\t' << counts.lost << '\t' << counts.late << '\t' << counts.duplicates << '\t'
       << counts.invalid << '\t' << counts.restarts;
  return text.str();
}

TEST(Reassembly, TheCasesAreThoseOfPython)
{
  std::ifstream cases(REASSEMBLY_CASES);
  Reassembler reassembler;
  int count = 0;
  for (std::string line; std::getline(cases, line); ++count) {
    std::istringstream columns(line);
    std::string kind, out;
    std::int64_t milliseconds;
    columns >> kind;
    if (kind == "reset") {
      columns >> milliseconds;
      reassembler = Reassembler(std::chrono::milliseconds(milliseconds));
    } else if (kind == "part") {
      Part part{};
      columns >> milliseconds >> part.frame >> part.place >> part.count >> out;
      // Not at the epoch of the clock, which is not the time of a part.
      const Reassembler::Clock::time_point now{std::chrono::hours(1) + std::chrono::milliseconds(milliseconds)};
      EXPECT_EQ(text_of(reassembler.add(part, now)), out) << line;
    } else if (kind == "counts") {
      EXPECT_EQ(text_of(reassembler.counts()), line.substr(line.find('\t') + 1));
    }
  }
  EXPECT_GT(count, 1000);
}

TEST(Reassembly, PartsComeOutInTheOrderOfTheirIndex)
{
  Reassembler reassembler;
  EXPECT_FALSE(reassembler.add({1, 2, 3}));
  EXPECT_FALSE(reassembler.add({1, 0, 3}));
  const auto frame = reassembler.add({1, 1, 3});
  ASSERT_TRUE(frame);
  for (std::uint32_t place = 0; place < 3; ++place) {
    EXPECT_EQ(frame->parts[place].index(), place);
  }
}

}  // namespace
