#ifndef ROVERLINK__CONTAINERS_HPP_
#define ROVERLINK__CONTAINERS_HPP_

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <roverlink/conversion_error.hpp>

namespace roverlink
{

/// Return the entries of a map in the order of their keys, so that equal payloads give equal messages.
template<typename Map>
std::vector<const typename Map::value_type *> sorted(const Map & map)
{
  std::vector<const typename Map::value_type *> entries;
  for (const auto & entry : map) {
    entries.push_back(&entry);
  }
  std::sort(
    entries.begin(), entries.end(), [](const auto * one, const auto * other) { return one->first < other->first; });
  return entries;
}

/// Add a key to a map and return a reference to the value of the key.
///
/// Throws ConversionError if the map has the key already, because one of the two values would be lost.
template<typename Map, typename Key>
typename Map::mapped_type & added(Map & map, const Key & key, const char * field)
{
  if (map.find(key) != map.end()) {
    throw ConversionError(field, "the key is repeated");
  }
  return map[key];
}

/// Convert each value of a repeated field and store it in an array.
///
/// Throws ConversionError if the number of values is not the length of the array.
template<typename Element, std::size_t LENGTH, typename Source, typename Make>
void fill(std::array<Element, LENGTH> & target, const Source & source, const char * field, Make make)
{
  const auto count = static_cast<std::size_t>(source.size());
  if (count != LENGTH) {
    throw ConversionError(field, std::to_string(count) + " values do not fit an array of " + std::to_string(LENGTH));
  }
  std::transform(source.begin(), source.end(), target.begin(), make);
}

/// Convert each value of a repeated field and store it in a sequence.
///
/// Throws ConversionError if there are more values than the bound of the sequence.
template<typename Sequence, typename Source, typename Make>
void fill(Sequence & target, const Source & source, const char * field, Make make)
{
  const auto count = static_cast<std::size_t>(source.size());
  // rosidl's BoundedVector has its bound as max_size(); that of a std::vector is larger than any message.
  if (count > target.max_size()) {
    throw ConversionError(field, std::to_string(count) + " values are more than " + std::to_string(target.max_size()));
  }
  target.clear();
  for (const auto & item : source) {
    target.push_back(make(item));
  }
}

}  // namespace roverlink

#endif  // ROVERLINK__CONTAINERS_HPP_
