// Peers for the tests of VRPN: a server on a thread of its own, and a raw TCP peer that can send anything.
#pragma once

#include <poll.h>
#include <sys/socket.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "haptics/vrpn/client.h"
#include "haptics/vrpn/message.h"
#include "haptics/vrpn/server.h"

namespace intaglio::haptics::vrpn {

// Generous: milliseconds are usually enough, but a loaded machine may take long.
inline constexpr std::chrono::seconds test_patience{20};

// Waits until `condition` holds; false if it never does.
template <class Condition>
bool eventually(Condition condition, std::chrono::milliseconds patience = test_patience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

class RunningServer {
 public:
  explicit RunningServer(ServerOptions options = {}) {
    options.port = 0;
    options.log = [this](const std::string& line) {
      const std::lock_guard lock(mutex_);
      log_ += line + "\n";
    };
    server_ = std::move(*Server::open(options));
    port = server_->port();
    thread_ = std::thread([this] {
      while (!stopped_) {
        {
          const std::lock_guard lock(step_mutex_);
          server_->step(std::chrono::steady_clock::now());
        }
        std::this_thread::sleep_for(std::chrono::microseconds(500));
      }
    });
  }
  ~RunningServer() {
    stopped_ = true;
    thread_.join();
  }

  // Calls `question` with the server, between two of its steps.
  template <class Question>
  auto ask(Question question) {
    const std::lock_guard lock(step_mutex_);
    return question(*server_);
  }
  std::string log() {
    const std::lock_guard lock(mutex_);
    return log_;
  }
  Address address(bool tcp_only) const { return {"Phantom0", "127.0.0.1", port, tcp_only}; }

  int port = 0;

 private:
  std::unique_ptr<Server> server_;
  std::mutex mutex_, step_mutex_;
  std::string log_;
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

class RawPeer {
 public:
  explicit RawPeer(int port) : socket_(std::move(*dial_tcp({loopback_host, port}))) {
    eventually([&] { return is_connected(socket_); });
  }

  // False once the peer has hung up.
  bool write(View bytes) {
    while (!bytes.empty()) {
      const ssize_t size = ::send(socket_.fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (size < 0 && errno != EAGAIN) return false;
      if (size < 0) {
        pollfd polled{socket_.fd(), POLLOUT, 0};
        ::poll(&polled, 1, 100);
        read();
      } else {
        bytes = bytes.subspan(std::size_t(size));
      }
    }
    return true;
  }
  bool greet() { return write(our_cookie()); }
  // Discards everything received; false once the peer has hung up.
  bool read() {
    std::uint8_t buffer[65536];
    for (;;) {
      const ssize_t size = ::recv(socket_.fd(), buffer, sizeof buffer, 0);
      if (size == 0 || (size < 0 && errno != EAGAIN)) return false;
      if (size < 0) return true;
    }
  }
  bool hung_up() {
    return eventually([&] { return !read(); });
  }
  // Still linked after a while.
  bool kept(std::chrono::milliseconds for_long = std::chrono::milliseconds(100)) {
    return !eventually([&] { return !read(); }, for_long);
  }

 private:
  Socket socket_;
};

// The descriptions of a client that gives its one sender id 0 and its types our ids.
inline Bytes introduction(std::string_view name = "Phantom0") {
  Bytes out, payload;
  encode_name(payload, name);
  append_message(out, {{}, 0, sender_description, 0, payload});
  for (std::size_t id = 0; id < type_names.size(); ++id) {
    payload.clear();
    encode_name(payload, type_names[id]);
    append_message(out, {{}, std::int32_t(id), type_description, 0, payload});
  }
  return out;
}

template <class T>
Bytes framed(Type type, const T& message) {
  Bytes out, payload;
  encode(payload, message);
  append_message(out, {{}, 0, std::int32_t(type), 0, payload});
  return out;
}

}  // namespace intaglio::haptics::vrpn
