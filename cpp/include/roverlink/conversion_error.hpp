#ifndef ROVERLINK__CONVERSION_ERROR_HPP_
#define ROVERLINK__CONVERSION_ERROR_HPP_

#include <stdexcept>
#include <string>

namespace roverlink
{

/// Error: a value does not fit the type to which it is converted.
///
/// Conversions never change such a value to the nearest one that fits, and never leave it out silently.
class ConversionError : public std::runtime_error
{
public:
  /// `place` is the path of the field, for example "Survey.mode".
  ConversionError(const std::string & place, const std::string & what)
  : std::runtime_error(place + ": " + what)
  {
  }

  /// Return the same error with the name of the row before the path of the field.
  ConversionError in_row(const std::string & row) const
  {
    return ConversionError(row + "." + what());
  }

private:
  explicit ConversionError(const std::string & whole)
  : std::runtime_error(whole)
  {
  }
};

}  // namespace roverlink

#endif  // ROVERLINK__CONVERSION_ERROR_HPP_
