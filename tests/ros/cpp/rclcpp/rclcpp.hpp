// Stands in for rclcpp, which Debian does not have: as much of its interface as the generated header uses, with topics
// that are functions. What it shows is that the header compiles and does the right thing with publishers and
// subscriptions; not that rclcpp takes it.

#ifndef RCLCPP__RCLCPP_HPP_
#define RCLCPP__RCLCPP_HPP_

#include <any>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#define RCLCPP_WARN(logger, ...) (static_cast<void>(logger), std::printf(__VA_ARGS__), std::printf("\n"))

namespace rclcpp
{

struct KeepLast
{
  explicit KeepLast(std::size_t depth)
  : depth(depth) {}
  std::size_t depth;
};

struct QoS
{
  explicit QoS(KeepLast history)
  : said("keep_last " + std::to_string(history.depth)) {}
  QoS & keep_all() {said += " keep_all"; return *this;}
  QoS & best_effort() {said += " best_effort"; return *this;}
  QoS & transient_local() {said += " transient_local"; return *this;}
  std::string said;
};

struct SubscriptionBase
{
  using SharedPtr = std::shared_ptr<SubscriptionBase>;
  virtual ~SubscriptionBase() = default;
};

struct Logger {};

/// By topic, what a message is given to; and by topic, how often one was published.
inline std::map<std::string, std::any> subscribers;
inline std::map<std::string, int> published;

template<typename Message>
struct Publisher
{
  void publish(const Message &) {++published[topic];}
  std::string topic;
};

struct Time
{
  int64_t nanoseconds() const {return 1'500'000'000;}
};

struct Clock
{
  Time now() const {return {};}
};

class Node
{
public:
  explicit Node(const std::string &) {}

  Logger get_logger() const {return {};}
  std::shared_ptr<Clock> get_clock() {return std::make_shared<Clock>();}

  template<typename Message>
  std::shared_ptr<Publisher<Message>> create_publisher(const std::string & topic, const QoS &)
  {
    return std::make_shared<Publisher<Message>>(Publisher<Message>{topic});
  }

  template<typename Message, typename Callback>
  std::shared_ptr<SubscriptionBase> create_subscription(
    const std::string & topic, const QoS &, Callback && callback)
  {
    subscribers[topic] = std::function<void (std::shared_ptr<const Message>)>(callback);
    return std::make_shared<SubscriptionBase>();
  }
};

}  // namespace rclcpp

#endif  // RCLCPP__RCLCPP_HPP_
