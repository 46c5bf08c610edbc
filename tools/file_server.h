// Serves folders to browsers: HTTP/1.1, by Boost.Beast.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace occlod::tool {

// Maps paths below `prefix` to a folder. Nothing outside the folder is served, whatever links and names say.
struct ServedFolder {
  std::string prefix;  // "/name/"
  std::filesystem::path folder;
};

struct ServerOptions {
  std::string host = "127.0.0.1";  // an address of this machine, in numbers; 0.0.0.0 or ::, all of them
  std::uint16_t port = 0;          // 0: any free one
  std::string page;                // the HTML at "/"
  std::vector<ServedFolder> folders;
  std::size_t max_connections = 256;          // at once; others wait
  std::chrono::milliseconds patience{10000};  // time limit for a request, and for taking a part of an answer
};

// Answers GET and HEAD, with ranges, until SIGINT or SIGTERM. Calls `ready` with the port. Pages of any origin may read
// what is served (CORS): viewers come from elsewhere. Throws Error for a host that is no address, and when host or port
// cannot be had.
void serve(const ServerOptions& options, const std::function<void(std::uint16_t port)>& ready);

}  // namespace occlod::tool
