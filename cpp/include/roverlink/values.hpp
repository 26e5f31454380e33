#ifndef ROVERLINK__VALUES_HPP_
#define ROVERLINK__VALUES_HPP_

// All headers with conversions of single values. Almost every generated source file includes this header.

#include <roverlink/containers.hpp>
#include <roverlink/conversion_error.hpp>
#include <roverlink/enums.hpp>
#include <roverlink/numbers.hpp>
#include <roverlink/stamp.hpp>
#include <roverlink/text.hpp>

#endif  // ROVERLINK__VALUES_HPP_
