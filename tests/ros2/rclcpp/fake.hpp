// The calls of rclcpp that the emitted node in C++ makes, for tests without ROS 2.
//
// The contract stands at each call: what rclcpp and rclcpp_lifecycle document of it (Humble to
// Jazzy). What is published goes to standard output, a line each: topic, tab, what the message's
// `tell` says. `spin_once` makes one step of the script on standard input: a transition; `now NS`,
// the node's clock; `beat`, all wall timers; a topic and numbers, a message; `offer TOPIC TYPE BYTE`,
// a publisher of this type, the definition of which has a hash of such bytes, 0 for none; `withdraw
// TOPIC`, its end; `signal`; `end`, of the context; `fail`.
// With FAKE_HUMBLE, endpoints have no hash.
#ifndef FAKE_RCLCPP_HPP
#define FAKE_RCLCPP_HPP

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "messages.hpp"

#if __has_include(<rosidl_runtime_c/type_hash.h>)
#include <rosidl_runtime_c/type_hash.h>
#else
struct rosidl_type_hash_t
{
  std::uint8_t version;
  std::uint8_t value[32];
};
#endif

namespace fake
{

inline rosidl_type_hash_t hash(int byte)
{
  rosidl_type_hash_t found{};
  found.version = byte == 0 ? 0 : 1;
  for (std::uint8_t & each : found.value) {
    each = static_cast<std::uint8_t>(byte);
  }
  return found;
}
constexpr int OWN = 17;  // The bytes of the hash of each type that the node knows.

inline std::int64_t now = 0;
inline bool is_running = false;
inline std::vector<std::function<void()>> timers;
inline std::map<std::string, std::function<void(std::istream &)>> subscriptions;
inline std::function<bool(const std::string &)> transition;

}  // namespace fake

#define RCLCPP_ERROR(logger, ...) ((void)(logger), std::fprintf(stderr, __VA_ARGS__))

namespace rclcpp
{

struct InitOptions {};
enum class SignalHandlerOptions { All, SigInt, SigTerm, None };

// Raises where it is called twice.
inline void init(int, char **, const InitOptions &, SignalHandlerOptions)
{
  if (fake::is_running) {
    throw std::runtime_error("context is already initialized");
  }
  fake::is_running = true;
}
inline bool ok() {return fake::is_running;}
inline bool shutdown()
{
  fake::is_running = false;
  return true;
}

// Keep-last with this depth, reliable and volatile, unless it says otherwise.
class QoS
{
public:
  explicit QoS(std::size_t depth)
  : text(std::to_string(depth)) {}
  QoS & reliable() {text += " reliable"; return *this;}
  QoS & transient_local() {text += " transient local"; return *this;}
  std::string text;
};
// Best effort, depth 5.
class SensorDataQoS : public QoS
{
public:
  SensorDataQoS()
  : QoS(5) {text += " best effort";}
};

class Time
{
public:
  explicit Time(std::int64_t nanoseconds)
  : nanoseconds_(nanoseconds) {}
  std::int64_t nanoseconds() const {return nanoseconds_;}
  operator builtin_interfaces::msg::Time() const
  {
    builtin_interfaces::msg::Time found;
    found.sec = static_cast<std::int32_t>(nanoseconds_ / 1000000000);
    found.nanosec = static_cast<std::uint32_t>(nanoseconds_ % 1000000000);
    return found;
  }

private:
  std::int64_t nanoseconds_;
};

// Nothing is published once the context is shut down.
template<class Message>
class Publisher
{
public:
  using SharedPtr = std::shared_ptr<Publisher>;
  explicit Publisher(std::string topic)
  : topic_(std::move(topic)) {}
  virtual ~Publisher() = default;
  virtual void publish(const Message & message)
  {
    if (!fake::is_running) {
      throw std::runtime_error("publisher's context is invalid");
    }
    std::cout << topic_ << '\t' << tell(message) << std::endl;
  }
  // A duration that is negative waits for ever.
  template<class Repr, class Period>
  bool wait_for_all_acked(std::chrono::duration<Repr, Period> timeout) const
  {
    if (timeout.count() <= 0) {
      throw std::logic_error("no wait, or one for ever");
    }
    return true;
  }

private:
  std::string topic_;
};

class SubscriptionBase
{
public:
  using SharedPtr = std::shared_ptr<SubscriptionBase>;
  explicit SubscriptionBase(std::string topic)
  : topic_(std::move(topic)) {}
  ~SubscriptionBase() {fake::subscriptions.erase(topic_);}
  // The full name, after remapping.
  const char * get_topic_name() const {return topic_.c_str();}

private:
  std::string topic_;
};

class TimerBase
{
public:
  using SharedPtr = std::shared_ptr<TimerBase>;
  ~TimerBase() {fake::timers.clear();}
};

// A publisher or a subscription, as the graph has it.
class TopicEndpointInfo
{
public:
  TopicEndpointInfo(std::string node, std::string type, rosidl_type_hash_t hash)
  : node_(std::move(node)), type_(std::move(type)), hash_(hash) {}
  const std::string & node_name() const {return node_;}
  const std::string & node_namespace() const {return space_;}
  const std::string & topic_type() const {return type_;}
#ifndef FAKE_HUMBLE
  const rosidl_type_hash_t & topic_type_hash() const {return hash_;}  // Since Iron.
#endif

private:
  std::string node_, space_ = "/", type_;
  [[maybe_unused]] rosidl_type_hash_t hash_;
};

}  // namespace rclcpp

namespace fake
{
inline std::map<std::string, rclcpp::TopicEndpointInfo> publishers;
inline std::map<std::string, std::string> types;  // Of the topics that the node reads.
}  // namespace fake

namespace rclcpp
{

struct Logger {};
using ParameterValue = std::variant<double, std::vector<std::string>>;
class Parameter
{
public:
  explicit Parameter(ParameterValue value)
  : value_(std::move(value)) {}
  double as_double() const {return std::get<double>(value_);}
  std::vector<std::string> as_string_array() const
  {
    return std::get<std::vector<std::string>>(value_);
  }

private:
  ParameterValue value_;
};

struct NodeBase {};

}  // namespace rclcpp

namespace rclcpp_lifecycle
{

struct State {};

namespace node_interfaces
{
// A callback that throws counts as ERROR.
struct LifecycleNodeInterface
{
  enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
};
}  // namespace node_interfaces

struct Managed
{
  virtual ~Managed() = default;
  bool enabled = false;
};

// What it is to publish while the node is not active is dropped.
template<class Message>
class LifecyclePublisher : public rclcpp::Publisher<Message>, public Managed
{
public:
  using SharedPtr = std::shared_ptr<LifecyclePublisher>;
  using rclcpp::Publisher<Message>::Publisher;
  void publish(const Message & message) override
  {
    if (enabled) {
      rclcpp::Publisher<Message>::publish(message);
    }
  }
};

class LifecycleNode
{
public:
  using CallbackReturn = node_interfaces::LifecycleNodeInterface::CallbackReturn;

  explicit LifecycleNode(std::string name)
  : name_(std::move(name)), full_name_("/" + name_) {}
  virtual ~LifecycleNode() = default;

  // The callbacks of this class enable (activate) and disable (deactivate) the managed publishers.
  virtual CallbackReturn on_configure(const State &) {return CallbackReturn::SUCCESS;}
  virtual CallbackReturn on_activate(const State &) {return enable(true);}
  virtual CallbackReturn on_deactivate(const State &) {return enable(false);}
  virtual CallbackReturn on_cleanup(const State &) {return CallbackReturn::SUCCESS;}
  virtual CallbackReturn on_shutdown(const State &) {return CallbackReturn::SUCCESS;}
  virtual CallbackReturn on_error(const State &) {return CallbackReturn::FAILURE;}

  // A parameter of the type of its default; overrides are ignored where the last one says so.
  template<class Value>
  void declare_parameter(
    const std::string & name, const Value & value,
    const rcl_interfaces::msg::ParameterDescriptor &, bool = false)
  {
    parameters_.emplace(name, rclcpp::ParameterValue(value));
  }
  rclcpp::Parameter get_parameter(const std::string & name) const
  {
    return rclcpp::Parameter(parameters_.at(name));
  }

  template<class Message>
  typename LifecyclePublisher<Message>::SharedPtr create_publisher(
    const std::string & topic, const rclcpp::QoS & qos)
  {
    std::cout << "publisher\t" << topic << ": " << qos.text << std::endl;
    auto made = std::make_shared<LifecyclePublisher<Message>>(topic);
    managed_.push_back(made);
    return made;
  }

  template<class Message, class Callback>
  rclcpp::SubscriptionBase::SharedPtr create_subscription(
    const std::string & topic, const rclcpp::QoS & qos, Callback callback)
  {
    std::cout << "subscription\t" << topic << ": " << qos.text << std::endl;
    fake::types[topic] = type_name(static_cast<const Message *>(nullptr));
    fake::subscriptions[topic] = [callback](std::istream & text) {
        callback(std::make_shared<const Message>(made<Message>(text)));
      };
    return std::make_shared<rclcpp::SubscriptionBase>(topic);
  }

  // On a steady clock.
  template<class Period>
  rclcpp::TimerBase::SharedPtr create_wall_timer(Period, std::function<void()> callback)
  {
    fake::timers.push_back(callback);
    return std::make_shared<rclcpp::TimerBase>();
  }

  // The publishers and the subscriptions of a topic, by its full name.
  std::vector<rclcpp::TopicEndpointInfo> get_publishers_info_by_topic(const std::string & topic) const
  {
    const auto found = fake::publishers.find(topic);
    return found == fake::publishers.end() ? std::vector<rclcpp::TopicEndpointInfo>() :
           std::vector<rclcpp::TopicEndpointInfo>{found->second};
  }
  std::vector<rclcpp::TopicEndpointInfo> get_subscriptions_info_by_topic(
    const std::string & topic) const
  {
    const std::string type = fake::types.at(topic);
    return {{"recorder", type, fake::hash(99)}, {name_, type, fake::hash(fake::OWN)}};
  }

  rclcpp::Time now() const {return rclcpp::Time(fake::now);}
  const char * get_name() const {return name_.c_str();}
  const char * get_fully_qualified_name() const {return full_name_.c_str();}
  rclcpp::Logger get_logger() const {return {};}
  rclcpp::NodeBase * get_node_base_interface()
  {
    fake::transition = [this](const std::string & name) {return change(name);};
    return nullptr;
  }

private:
  CallbackReturn enable(bool enabled)
  {
    for (const auto & each : managed_) {
      if (const auto publisher = each.lock()) {
        publisher->enabled = enabled;
      }
    }
    return CallbackReturn::SUCCESS;
  }

  bool change(const std::string & name)
  {
    using Call = CallbackReturn (LifecycleNode::*)(const State &);
    struct Step { const char * from; const char * name; Call call; const char * to; };
    const Step steps[] = {
      {"unconfigured", "configure", &LifecycleNode::on_configure, "inactive"},
      {"inactive", "activate", &LifecycleNode::on_activate, "active"},
      {"active", "deactivate", &LifecycleNode::on_deactivate, "inactive"},
      {"inactive", "cleanup", &LifecycleNode::on_cleanup, "unconfigured"},
      {"active", "shutdown", &LifecycleNode::on_shutdown, "finalized"},
    };
    for (const Step & step : steps) {
      if (state_ == step.from && name == step.name) {
        const auto result = (this->*step.call)(State());
        state_ = result == CallbackReturn::SUCCESS ? step.to : state_;
        std::cout << "state\t" << state_ << std::endl;
        return true;
      }
    }
    return false;
  }

  std::string name_, full_name_, state_ = "unconfigured";
  std::map<std::string, rclcpp::ParameterValue> parameters_;
  std::vector<std::weak_ptr<Managed>> managed_;
};

}  // namespace rclcpp_lifecycle

namespace rclcpp
{

// A publisher that is not managed.
template<class Message>
typename Publisher<Message>::SharedPtr create_publisher(
  rclcpp_lifecycle::LifecycleNode &, const std::string & topic, const QoS &)
{
  return std::make_shared<Publisher<Message>>(topic);
}

namespace executors
{
class SingleThreadedExecutor
{
public:
  void add_node(NodeBase *) {}

  // Wait for one callback at most so long, and make it. What it throws comes out of it.
  void spin_once(std::chrono::nanoseconds)
  {
    std::string line, word;
    if (!std::getline(std::cin, line)) {
      throw std::runtime_error("the script has ended");
    }
    std::istringstream text(line);
    text >> word;
    if (word == "now") {
      text >> fake::now;
    } else if (word == "beat") {
      for (const auto & each : fake::timers) {
        each();
      }
    } else if (word == "offer") {
      std::string topic, type;
      int byte = 0;
      text >> topic >> type >> byte;
      fake::publishers.insert_or_assign(
        topic, rclcpp::TopicEndpointInfo("robot", type, fake::hash(byte)));
    } else if (word == "withdraw") {
      std::string topic;
      text >> topic;
      fake::publishers.erase(topic);
    } else if (word == "signal") {
      std::raise(SIGINT);
    } else if (word == "end") {
      rclcpp::shutdown();
    } else if (word == "fail") {
      throw std::runtime_error("the middleware is gone");
    } else if (fake::subscriptions.count(word) > 0) {
      fake::subscriptions[word](text);
    } else {
      fake::transition(word);
    }
  }
};
}  // namespace executors

}  // namespace rclcpp

#endif  // FAKE_RCLCPP_HPP
