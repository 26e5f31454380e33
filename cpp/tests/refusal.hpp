#ifndef REFUSAL_HPP_
#define REFUSAL_HPP_

#include <string>

#include <roverlink/conversion_error.hpp>

/// Return the message of the ConversionError that a function throws; empty if it throws none.
template<typename Function>
std::string refusal(Function function)
{
  try {
    function();
    return "";
  } catch (const roverlink::ConversionError & error) {
    return error.what();
  }
}

#endif  // REFUSAL_HPP_
