// Folders of this machine for its own browsers: HTTP/1.1 on 127.0.0.1, by Boost.Beast.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace occlod::tool {

// What is below `prefix` comes from a folder; nothing that lies outside it, whatever links and names say.
struct ServedFolder {
  std::string prefix;  // "/name/"
  std::filesystem::path folder;
};

struct ServerOptions {
  std::uint16_t port = 0;  // 0: any that is free
  std::string page;        // the HTML at "/"
  std::vector<ServedFolder> folders;
  std::size_t max_connections = 256;          // at once; others wait
  std::chrono::milliseconds patience{10000};  // a client has so long for a request, or for taking a part of an answer
};

// Answers GET and HEAD, with ranges, until SIGINT or SIGTERM. `ready` is told the port. Requests by other names than
// those of this machine are refused, so that no page of a foreign name reaches the server (DNS rebinding). Throws Error
// when the port cannot be had.
void serve(const ServerOptions& options, const std::function<void(std::uint16_t port)>& ready);

}  // namespace occlod::tool
