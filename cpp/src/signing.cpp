#include <roverlink/signing.hpp>

#include <chrono>
#include <stdexcept>
#include <utility>

namespace roverlink
{

namespace
{

constexpr std::size_t largest_datagram = 65507;  // bytes of UDP payload over IPv4
constexpr std::size_t largest_signature = 21;    // bytes, with the longest tag

using ticks = std::chrono::duration<std::int64_t, std::ratio<1, ROVERLINK_TICKS_PER_SECOND>>;

template<typename Clock>
std::int64_t now()
{
  return std::chrono::duration_cast<ticks>(Clock::now().time_since_epoch()).count();
}

std::uint64_t steady_now()
{
  return static_cast<std::uint64_t>(now<std::chrono::steady_clock>());
}

}  // namespace

roverlink_key signing_key(std::uint8_t id, const std::string & secret, std::uint64_t last)
{
  roverlink_key key;
  if (!roverlink_key_set(&key, id, secret.c_str(), last)) {
    throw std::invalid_argument("the secret of a key does not have 64 hexadecimal digits");
  }
  return key;
}

SigningClock::SigningClock(std::uint64_t earliest)
{
  roverlink_clock_start(&clock_, earliest, steady_now());
}

std::uint64_t SigningClock::next()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::uint64_t steady = steady_now();
  follow_wall(steady);
  return roverlink_clock_next(&clock_, steady);
}

void SigningClock::follow_wall(std::uint64_t steady)
{
  constexpr std::int64_t epoch = 1420070400LL * ROVERLINK_TICKS_PER_SECOND;  // 2015-01-01 UTC
  const std::int64_t wall = now<std::chrono::system_clock>() - epoch;
  if (wall > 0) {
    roverlink_clock_hear(&clock_, static_cast<std::uint64_t>(wall), steady);
  }
}

Signer::Signer(std::uint32_t number, const roverlink_key & key, SigningClock & clock)
: number_(number), key_(key), clock_(clock)
{
}

std::string Signer::sign(std::string_view datagram)
{
  std::string signed_one(datagram);
  signed_one.resize(datagram.size() + largest_signature);
  auto * bytes = reinterpret_cast<std::uint8_t *>(signed_one.data());
  signed_one.resize(
    roverlink_sign(&key_, number_, clock_.next(), bytes, datagram.size(), signed_one.size()));
  return signed_one;
}

Verifier::Verifier(std::uint32_t number, std::vector<roverlink_key> keys, SigningClock & clock)
: number_(number), keys_(std::move(keys)), clock_(clock)
{
}

roverlink_verdict Verifier::verify(std::string & datagram)
{
  std::size_t length = datagram.size();
  const std::size_t capacity = length > largest_datagram ? length : largest_datagram;
  datagram.resize(capacity);
  const std::lock_guard<std::mutex> lock(clock_.mutex_);
  const std::uint64_t steady = steady_now();
  clock_.follow_wall(steady);
  const roverlink_verdict verdict = roverlink_verify(
    keys_.data(), keys_.size(), number_, &clock_.clock_, steady, reinterpret_cast<std::uint8_t *>(datagram.data()),
    &length, capacity);
  datagram.resize(length);
  return verdict;
}

}  // namespace roverlink
