// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Messages between Firn and a guest's process: a kind, a length, and bytes.
/// Both ends run on one machine from one build, so values travel as they lie in memory.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "firn/state.hpp"
#include "guests/child_process.hpp"

namespace firn::guest {

enum class Kind : std::uint32_t {
  traits = 1,
  load,
  choose_time_step,
  advance,
  store,
  answer,
  failure
};

/// The peer broke the protocol, closed the channel, or took too long.
class ChannelError : public std::runtime_error {
 public:
  enum class Reason { closed, timeout, malformed };
  ChannelError(Reason why, const std::string& what) : std::runtime_error(what), reason(why) {}
  Reason reason;
};

class Packet {
 public:
  Packet() = default;
  Packet(Kind kind_of_it, std::vector<std::byte> bytes)
      : kind(kind_of_it), bytes_(std::move(bytes)) {}
  explicit Packet(Kind kind_of_it) : kind(kind_of_it) {}

  Kind kind = Kind::answer;

  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(&value, sizeof value);
  }
  void put(const std::string& text);
  template <class T>
  void put_all(const std::vector<T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    if (!values.empty()) append(values.data(), values.size() * sizeof(T));
  }

  template <class T>
  T get() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    extract(&value, sizeof value);
    return value;
  }
  std::string get_text();
  template <class T>
  void get_all(std::vector<T>& values) {
    const auto count = get<std::uint64_t>();
    if (count > (bytes_.size() - read_) / sizeof(T)) fail();
    values.resize(static_cast<std::size_t>(count));
    if (count > 0) extract(values.data(), values.size() * sizeof(T));
  }

  /// Throws ChannelError unless everything was read.
  void expect_end() const;
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  [[noreturn]] static void fail();
  void append(const void* data, std::size_t size);
  void extract(void* data, std::size_t size);

  std::vector<std::byte> bytes_;
  std::size_t read_ = 0;
};

void put_state(Packet& packet, const State& state);
State get_state(Packet& packet);

/// No packet about so many particles is longer: a state, with as many nodes as the cubic
/// kernel can reach, or a text.
std::uint64_t largest_packet(std::size_t particles);

/// Sends or receives one packet over the socket before the deadline.
void send(int socket, const Packet& packet, Clock::time_point deadline);
Packet receive(int socket, Clock::time_point deadline, std::uint64_t most_bytes);

}  // namespace firn::guest
