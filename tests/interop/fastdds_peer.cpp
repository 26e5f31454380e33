// A peer on ROS 2's wire that shares no code with the bridge: Fast DDS, set up as rmw_fastrtps does it for a node with
// ROS_LOCALHOST_ONLY=1. Samples are bytes: what was received is printed as it came, what is sent is written as given.
//
//   fastdds_peer DOMAIN subscribe TOPIC TYPE COUNT    prints COUNT samples, each as a line of hexadecimal
//   fastdds_peer DOMAIN publish TOPIC TYPE HEX COUNT  once a reader matches, writes the sample COUNT times, each of them
//                                                     when the one before was acknowledged, at most 20 a second
//   fastdds_peer DOMAIN graph                         prints endpoints and samples of ros_discovery_info as they appear,
//                                                     as lines of JSON
//
// TOPIC and TYPE are ROS 2's names: /imu_data, comms/msg/ImuSensorInformation.
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <functional>
#include <future>
#include <iostream>
#include <memory>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using Bytes = std::vector<uint8_t>;
using ReturnCode = eprosima::fastrtps::types::ReturnCode_t;

constexpr unsigned longest_run_s = 120;  // whoever started this program may have been killed
constexpr auto publish_interval = std::chrono::milliseconds(50);
constexpr int acknowledge_s = 10;

template <typename Pointer>
Pointer made(Pointer entity, const char* what) {
  if (!entity) throw std::runtime_error(std::string("Fast DDS made no ") + what);
  return entity;
}

std::string to_hex(const uint8_t* bytes, size_t size) {
  static constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (size_t i = 0; i < size; ++i) text += {digits[bytes[i] >> 4], digits[bytes[i] & 15]};
  return text;
}

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  for (size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

void print(const std::string& line) {  // called from Fast DDS's threads
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  std::cout << line << std::endl;
}

// comms/msg/Name is comms::msg::dds_::Name_ in DDS.
std::string dds_type_name(const std::string& ros) {
  const size_t first = ros.find('/'), last = ros.rfind('/');
  if (first == last) throw std::invalid_argument(ros + " is not of the form package/msg/Name");
  const std::string package = ros.substr(0, first), kind = ros.substr(first + 1, last - first - 1);
  return package + "::" + kind + "::dds_::" + ros.substr(last + 1) + "_";
}

// A type of which nothing is known but its name; a sample is its serialized form, the four bytes of header included.
class SerializedType : public fast::TopicDataType {
 public:
  explicit SerializedType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 4096;  // what a payload starts with; it grows
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const Bytes& sample = *static_cast<Bytes*>(data);
    payload->reserve(static_cast<uint32_t>(sample.size()));
    std::memcpy(payload->data, sample.data(), sample.size());
    payload->length = static_cast<uint32_t>(sample.size());
    payload->encapsulation = CDR_LE;
    return true;
  }

  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }

  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<uint32_t>(static_cast<Bytes*>(data)->size()); };
  }

  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

// Tells of every sample, from Fast DDS's own thread.
class Samples : public fast::DataReaderListener {
 public:
  explicit Samples(std::function<void(Bytes&)> take) : take_(std::move(take)) {}

  void on_data_available(fast::DataReader* reader) override {
    Bytes sample;
    fast::SampleInfo info;
    while (reader->take_next_sample(&sample, &info) == ReturnCode::RETCODE_OK) {
      if (info.valid_data) take_(sample);
    }
  }

 private:
  std::function<void(Bytes&)> take_;
};

// Prints every endpoint that DDS discovers.
class Endpoints : public fast::DomainParticipantListener {
 public:
  void on_publisher_discovery(fast::DomainParticipant*, rtps::WriterDiscoveryInfo&& found) override {
    if (found.status == rtps::WriterDiscoveryInfo::DISCOVERED_WRITER) show("writer", found.info);
  }

  void on_subscriber_discovery(fast::DomainParticipant*, rtps::ReaderDiscoveryInfo&& found) override {
    if (found.status == rtps::ReaderDiscoveryInfo::DISCOVERED_READER) show("reader", found.info);
  }

 private:
  template <typename Data>
  void show(const char* kind, const Data& found) {
    uint8_t gid[16];
    std::memcpy(gid, found.guid().guidPrefix.value, 12);
    std::memcpy(gid + 12, found.guid().entityId.value, 4);
    print(std::string("{\"kind\": \"") + kind + "\", \"gid\": \"" + to_hex(gid, sizeof gid) + "\", \"topic\": \"" +
          found.topicName().c_str() + "\", \"type\": \"" + found.typeName().c_str() + "\"}");
  }
};

// A participant; leaving the scope takes it off the network.
class Node {
 public:
  Node(int domain, fast::DomainParticipantListener* listener) {
    // As rmw_fastrtps has it where ROS_LOCALHOST_ONLY is 1, without the shared memory that others would not see.
    auto loopback = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    loopback->interfaceWhiteList.emplace_back("127.0.0.1");
    fast::DomainParticipantQos qos = fast::PARTICIPANT_QOS_DEFAULT;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(loopback);
    qos.wire_protocol().builtin.readerHistoryMemoryPolicy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    qos.wire_protocol().builtin.writerHistoryMemoryPolicy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    participant_ = made(factory_->create_participant(domain, qos, listener, fast::StatusMask::none()), "participant");
  }

  ~Node() {
    participant_->delete_contained_entities();
    factory_->delete_participant(participant_);
  }

  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  fast::DataWriter* writer(const std::string& topic, const std::string& type) {
    fast::Publisher* publisher = made(participant_->create_publisher(fast::PUBLISHER_QOS_DEFAULT), "publisher");
    fast::DataWriterQos qos = ros_default(fast::DATAWRITER_QOS_DEFAULT);
    qos.reliable_writer_qos().times.heartbeatPeriod = {0, 100'000'000};  // not 3 s: acknowledgments answer it
    return made(publisher->create_datawriter(add_topic(topic, type), qos), "writer");
  }

  fast::DataReader* reader(const std::string& topic, const std::string& type, fast::DataReaderListener* listener,
                           bool latched = false) {
    fast::Subscriber* subscriber = made(participant_->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT), "subscriber");
    fast::DataReaderQos qos = ros_default(fast::DATAREADER_QOS_DEFAULT);
    if (latched) {
      qos.durability().kind = fast::TRANSIENT_LOCAL_DURABILITY_QOS;
      qos.history().depth = 1;
    }
    return made(subscriber->create_datareader(add_topic(topic, type), qos, listener), "reader");
  }

 private:
  template <typename Qos>
  static Qos ros_default(Qos qos) {
    qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = fast::VOLATILE_DURABILITY_QOS;
    qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = 10;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    qos.data_sharing().off();
    return qos;
  }

  fast::Topic* add_topic(const std::string& name, const std::string& type) {
    fast::TypeSupport(new SerializedType(type)).register_type(participant_);
    return made(participant_->create_topic(name, type, fast::TOPIC_QOS_DEFAULT), "topic");
  }

  fast::DomainParticipantFactory* factory_ = fast::DomainParticipantFactory::get_instance();
  fast::DomainParticipant* participant_;
};

void subscribe(int domain, const std::string& topic, const std::string& type, int count) {
  std::promise<void> all_came;
  Samples samples([&all_came, left = count](Bytes& sample) mutable {
    if (left > 0) print(to_hex(sample.data(), sample.size()));
    if (--left == 0) all_came.set_value();
  });
  Node node(domain, nullptr);
  node.reader("rt" + topic, dds_type_name(type), &samples);
  all_came.get_future().wait();
}

void publish(int domain, const std::string& topic, const std::string& type, Bytes sample, int count) {
  Node node(domain, nullptr);
  fast::DataWriter* writer = node.writer("rt" + topic, dds_type_name(type));
  for (fast::PublicationMatchedStatus status; status.current_count == 0;) {
    writer->get_publication_matched_status(status);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  // The reader may match us later than we match it, and gets nothing that was written before; but only then does it
  // acknowledge the first sample, so whatever follows arrives.
  for (int i = 0; i < count; ++i) {
    if (i > 0) std::this_thread::sleep_for(publish_interval);
    if (!writer->write(&sample)) throw std::runtime_error("Fast DDS did not take a sample");
    if (writer->wait_for_acknowledgments({acknowledge_s, 0}) != ReturnCode::RETCODE_OK) {
      throw std::runtime_error("a sample was not acknowledged");
    }
  }
}

void graph(int domain) {
  Endpoints endpoints;
  Samples samples([](Bytes& sample) {
    print("{\"kind\": \"nodes\", \"sample\": \"" + to_hex(sample.data(), sample.size()) + "\"}");
  });
  Node node(domain, &endpoints);
  node.reader("ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_", &samples, true);
  pause();  // until killed
}

int main(int count, char** words) try {
  const std::vector<std::string> arguments(words + 1, words + count);
  alarm(longest_run_s);
  if (arguments.size() == 5 && arguments[1] == "subscribe") {
    subscribe(std::stoi(arguments[0]), arguments[2], arguments[3], std::stoi(arguments[4]));
  } else if (arguments.size() == 6 && arguments[1] == "publish") {
    publish(std::stoi(arguments[0]), arguments[2], arguments[3], from_hex(arguments[4]), std::stoi(arguments[5]));
  } else if (arguments.size() == 2 && arguments[1] == "graph") {
    graph(std::stoi(arguments[0]));
  } else {
    std::cerr << "fastdds_peer DOMAIN subscribe TOPIC TYPE COUNT | publish TOPIC TYPE HEX COUNT | graph\n";
    return 2;
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << "fastdds_peer: " << error.what() << "\n";
  return 1;
}
