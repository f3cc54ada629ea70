// SPDX-License-Identifier: BSD-3-Clause
#include "guests/packet.hpp"

#include <algorithm>
#include <cerrno>
#include <poll.h>
#include <sys/socket.h>

namespace firn::guest {

namespace {

struct Header {
  std::uint32_t magic = 0x4e524946;  // "FIRN"
  std::uint32_t kind = 0;
  std::uint64_t size = 0;
};

/// Waits until the socket is ready for `events`.
void wait_for(int socket, short events, Clock::time_point deadline) {
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) throw ChannelError(ChannelError::Reason::timeout, "no answer in time");
    pollfd item = {socket, events, 0};
    const int ready = poll(&item, 1, static_cast<int>(std::min<long long>(left, 1000000)));
    if (ready > 0) return;
    if (ready < 0 && errno != EINTR)
      throw ChannelError(ChannelError::Reason::closed, std::strerror(errno));
  }
}

void send_bytes(int socket, const void* data, std::size_t size, Clock::time_point deadline) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t sent = ::send(socket, at, size, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent > 0) {
      at += sent;
      size -= static_cast<std::size_t>(sent);
    } else if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      wait_for(socket, POLLOUT, deadline);
    } else if (sent < 0 && errno != EINTR) {
      throw ChannelError(ChannelError::Reason::closed, std::strerror(errno));
    }
  }
}

void receive_bytes(int socket, void* data, std::size_t size, Clock::time_point deadline) {
  char* at = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t got = ::recv(socket, at, size, MSG_DONTWAIT);
    if (got > 0) {
      at += got;
      size -= static_cast<std::size_t>(got);
    } else if (got == 0) {
      throw ChannelError(ChannelError::Reason::closed, "the channel was closed");
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      wait_for(socket, POLLIN, deadline);
    } else if (errno != EINTR) {
      throw ChannelError(ChannelError::Reason::closed, std::strerror(errno));
    }
  }
}

}  // namespace

void Packet::fail() {
  throw ChannelError(ChannelError::Reason::malformed, "a message of the wrong length");
}

void Packet::append(const void* data, std::size_t size) {
  const std::size_t old = bytes_.size();
  bytes_.resize(old + size);
  std::memcpy(bytes_.data() + old, data, size);
}

void Packet::extract(void* data, std::size_t size) {
  if (size > bytes_.size() - read_) fail();
  std::memcpy(data, bytes_.data() + read_, size);
  read_ += size;
}

void Packet::put(const std::string& text) {
  put(static_cast<std::uint64_t>(text.size()));
  append(text.data(), text.size());
}

std::string Packet::get_text() {
  const auto size = get<std::uint64_t>();
  if (size > bytes_.size() - read_) fail();
  std::string text(static_cast<std::size_t>(size), '\0');
  extract(text.data(), text.size());
  return text;
}

void Packet::expect_end() const {
  if (read_ != bytes_.size()) fail();
}

void put_state(Packet& packet, const State& state) {
  packet.put(state.time);
  packet.put(state.dt);
  packet.put(state.step);
  packet.put(static_cast<std::int32_t>(number(state.next)));
  // Vec3 and Mat3 are plain arrays of doubles; both ends share their layout.
  const auto put = [&](const char*, const auto& array) { packet.put_all(array); };
  for_each_field(put, state.particles);
  packet.put_all(state.grid.node);
  for_each_field(put, state.grid);
}

State get_state(Packet& packet) {
  State state;
  state.time = packet.get<double>();
  state.dt = packet.get<double>();
  state.step = packet.get<std::int64_t>();
  const auto next_stage = packet.get<std::int32_t>();
  if (next_stage < 1 || next_stage > stage_count)
    throw ChannelError(ChannelError::Reason::malformed, "a stage that does not exist");
  state.next = static_cast<Stage>(next_stage);
  const auto get = [&](const char*, auto& array) { packet.get_all(array); };
  for_each_field(get, state.particles);
  packet.get_all(state.grid.node);
  for_each_field(get, state.grid);
  return state;
}

void send(int socket, const Packet& packet, Clock::time_point deadline) {
  Header header;
  header.kind = static_cast<std::uint32_t>(packet.kind);
  header.size = packet.bytes().size();
  send_bytes(socket, &header, sizeof header, deadline);
  send_bytes(socket, packet.bytes().data(), packet.bytes().size(), deadline);
}

std::uint64_t largest_packet(std::size_t particles) {
  const State none;
  constexpr std::uint64_t scene_text = std::uint64_t{64} << 20;
  std::uint64_t particle = 0, node = sizeof(NodeIndex);
  const auto add_to = [](std::uint64_t& bytes) {
    return [&bytes]<class T>(const char*, const std::vector<T>&) { bytes += sizeof(T); };
  };
  for_each_field(add_to(particle), none.particles);
  for_each_field(add_to(node), none.grid);
  return scene_text + (particles + 1) * (particle + 64 * node);
}

Packet receive(int socket, Clock::time_point deadline, std::uint64_t most_bytes) {
  Header header;
  receive_bytes(socket, &header, sizeof header, deadline);
  if (header.magic != Header().magic || header.size > most_bytes)
    throw ChannelError(ChannelError::Reason::malformed, "sent something that is not a message");
  // A slice at a time: memory is taken for what has come, not for what was announced.
  constexpr std::uint64_t slice = 1 << 24;
  std::vector<std::byte> bytes;
  while (bytes.size() < header.size) {
    const std::size_t have = bytes.size();
    bytes.resize(static_cast<std::size_t>(std::min(header.size, have + slice)));
    receive_bytes(socket, bytes.data() + have, bytes.size() - have, deadline);
  }
  return Packet(static_cast<Kind>(header.kind), std::move(bytes));
}

}  // namespace firn::guest
