// Generated from mapping.yaml and survey.proto; do not edit.
// Regenerate with: roverlink generate

#include <rover/conversions/chain_level2.hpp>

#include <roverlink/values.hpp>

namespace rover::handlers
{

rover::msg::ChainLevel2 ChainLevel2Conversion::to_ros(const ::Chain & payload)
{
  roverlink::check_end(payload.has_next(), "ChainLevel2.next");
  rover::msg::ChainLevel2 message;
  message.class_field = payload.class_();
  return message;
}

::Chain ChainLevel2Conversion::from_ros(const rover::msg::ChainLevel2 & message)
{
  ::Chain payload;
  payload.set_class_(message.class_field);
  return payload;
}

}  // namespace rover::handlers
