#ifndef ROVERLINK__SIGNING_HPP_
#define ROVERLINK__SIGNING_HPP_

#include <roverlink_signing.h>

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace roverlink
{

/// Key of one sender, as `roverlink link keygen` writes it.
///
/// Throws std::invalid_argument if the secret is not 64 hexadecimal digits. The message does not contain the secret.
roverlink_key signing_key(std::uint8_t id, const std::string & secret, std::uint64_t last = 0);

/// Clock of the timestamps of a program: the computer's clock, which never goes back. Thread-safe.
class SigningClock
{
public:
  /// Start after the timestamp `earliest`, for example the last one of the previous run.
  explicit SigningClock(std::uint64_t earliest = 0);

  /// Return a timestamp that is larger than all earlier ones.
  std::uint64_t next();

private:
  friend class Verifier;
  void follow_wall(std::uint64_t steady);

  std::mutex mutex_;
  roverlink_clock clock_;
};

/// Signer of datagrams with one key.
class Signer
{
public:
  /// Prepare the key; `number` is the field number of the envelope's signature.
  Signer(std::uint32_t number, const roverlink_key & key, SigningClock & clock);

  /// Return a serialized envelope with a signature at its end.
  std::string sign(std::string_view datagram);

private:
  std::uint32_t number_;
  roverlink_key key_;
  SigningClock & clock_;
};

/// Verifier of signed datagrams. To be used from one thread.
class Verifier
{
public:
  /// Accept the given keys; `number` is the field number of the envelope's signature.
  Verifier(std::uint32_t number, std::vector<roverlink_key> keys, SigningClock & clock);

  /// Accept or refuse a datagram; zeros at its end that were stripped or appended are restored in it.
  roverlink_verdict verify(std::string & datagram);

  /// Keys with the latest timestamps that were accepted, to store them.
  const std::vector<roverlink_key> & keys() const { return keys_; }

private:
  std::uint32_t number_;
  std::vector<roverlink_key> keys_;
  SigningClock & clock_;
};

}  // namespace roverlink

#endif  // ROVERLINK__SIGNING_HPP_
