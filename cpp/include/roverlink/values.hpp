#ifndef ROVERLINK__VALUES_HPP_
#define ROVERLINK__VALUES_HPP_

// The conversions of single values, which almost every generated source needs.

#include <roverlink/containers.hpp>
#include <roverlink/conversion_error.hpp>
#include <roverlink/enums.hpp>
#include <roverlink/numbers.hpp>
#include <roverlink/stamp.hpp>
#include <roverlink/text.hpp>

#endif  // ROVERLINK__VALUES_HPP_
