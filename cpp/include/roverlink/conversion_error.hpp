#ifndef ROVERLINK__CONVERSION_ERROR_HPP_
#define ROVERLINK__CONVERSION_ERROR_HPP_

#include <stdexcept>
#include <string>

namespace roverlink
{

/// A value that does not fit the type it is converted to. Conversions never clamp a value and never drop one silently.
class ConversionError : public std::runtime_error
{
public:
  /// `place` is the path of the field, for example "Survey.mode".
  ConversionError(const std::string & place, const std::string & what)
  : std::runtime_error(place + ": " + what)
  {
  }

  /// Return the same error with the name of the row before the field.
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
