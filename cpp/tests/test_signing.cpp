#include <roverlink/signing.hpp>

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace
{

std::string secret() { return std::string(62, '0') + "7f"; }

std::string bytes_of(const std::string & hexadecimal)
{
  std::string made;
  for (std::size_t place = 0; place < hexadecimal.size(); place += 2) {
    made += static_cast<char>(std::stoi(hexadecimal.substr(place, 2), nullptr, 16));
  }
  return made;
}

std::vector<std::string> columns_of(const std::string & line)
{
  std::vector<std::string> columns;
  std::istringstream stream(line);
  for (std::string column; std::getline(stream, column, '\t');) {
    columns.push_back(column);
  }
  return columns;
}

TEST(Signing, TheVectorsAreThoseOfPythonAndC)
{
  const std::vector<std::string> verdicts{"accepted",        "unsigned", "malformed_signature", "unknown_key",
                                          "wrong_signature", "replayed", "outdated",            "ahead"};
  std::ifstream vectors(SIGNING_VECTORS);
  int count = 0;
  for (std::string line; std::getline(vectors, line);) {
    if (line[0] == '#') {
      continue;
    }
    const auto columns = columns_of(line);
    const auto number = static_cast<std::uint32_t>(std::stoul(columns[1]));
    const std::uint64_t timestamp = std::stoull(columns[4]);
    auto key = roverlink::signing_key(static_cast<std::uint8_t>(std::stoi(columns[2])), columns[3], timestamp);
    std::string datagram = bytes_of(columns[5]);
    std::size_t length = datagram.size();
    datagram.resize(1000);
    auto * bytes = reinterpret_cast<std::uint8_t *>(datagram.data());
    if (columns[0] == "sign") {
      datagram.resize(roverlink_sign(&key, number, timestamp, bytes, length, datagram.size()));
      EXPECT_EQ(datagram, bytes_of(columns[6])) << line;
    } else {
      roverlink_clock clock;
      roverlink_clock_start(&clock, timestamp, 0);
      const auto verdict = roverlink_verify(&key, 1, number, &clock, 0, bytes, &length, datagram.size());
      EXPECT_EQ(verdicts[verdict], columns[6]) << line;
    }
    ++count;
  }
  EXPECT_GT(count, 40);
}

TEST(Signing, ASignedDatagramIsAcceptedOnceAlsoWithZeros)
{
  roverlink::SigningClock here, there;
  const auto key = roverlink::signing_key(1, secret());
  roverlink::Signer signer(23, key, here);
  roverlink::Verifier verifier(23, {key}, there);
  for (int count = 0; count < 300; ++count) {  // at least one of the signatures ends with a zero
    std::string datagram = signer.sign("\x6a\x01x");
    const std::string whole = datagram;
    datagram.resize(datagram.find_last_not_of('\0') + 1);
    datagram += std::string(static_cast<std::size_t>(count % 3) * 20, '\0');
    EXPECT_EQ(verifier.verify(datagram), ROVERLINK_ACCEPTED);
    EXPECT_EQ(datagram, whole);
    EXPECT_EQ(verifier.verify(datagram), ROVERLINK_REPLAYED);
  }
  EXPECT_GT(verifier.keys()[0].last, 0U);
}

TEST(Signing, TwoKeysAreValidDuringARotation)
{
  roverlink::SigningClock clock;
  const auto old_key = roverlink::signing_key(1, secret()), new_key = roverlink::signing_key(2, std::string(64, 'a'));
  roverlink::Verifier verifier(23, {old_key, new_key}, clock);
  std::string first = roverlink::Signer(23, old_key, clock).sign("x"), second = roverlink::Signer(23, new_key, clock).sign("x");
  EXPECT_EQ(verifier.verify(first), ROVERLINK_ACCEPTED);
  EXPECT_EQ(verifier.verify(second), ROVERLINK_ACCEPTED);
}

TEST(Signing, TheTimeContinuesAfterThatOfTheLastRun)
{
  const std::uint64_t later = 200000000000000;  // in the year 2078
  roverlink::SigningClock clock(later);
  EXPECT_GT(clock.next(), later);
}

TEST(Signing, AWrongSecretIsRefusedWithoutShowingIt)
{
  const std::string wrong = std::string(63, '0') + "g";
  EXPECT_THROW(roverlink::signing_key(1, "00"), std::invalid_argument);
  try {
    roverlink::signing_key(1, wrong);
    FAIL();
  } catch (const std::invalid_argument & error) {
    EXPECT_EQ(std::string(error.what()).find(wrong), std::string::npos);
  }
}

}  // namespace
