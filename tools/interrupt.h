// Handles SIGINT (Ctrl-C) and SIGTERM in a command that writes a file. Before it writes, they end it at once, since
// there is nothing to undo. While it writes, they end it after the current block, which removes the half-written file
// and keeps the old one. Once the file is in place they are too late, and the command ends as usual.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>

#include "base/atomic_file.h"
#include "progress.h"

namespace occlod::tool {

class Interrupted : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override;  // "build: was cancelled"
  [[nodiscard]] int exit_code() const noexcept;              // 128 + the signal's number, as in shells
};

// Installs the handlers, once per process. A signal that the parent ignores (nohup, background jobs of scripts) stays
// ignored.
void handle_interrupts(const std::string& command);

// From now on signals are only recorded. Throws Interrupted when one has been.
void note_interrupts();

// Calls write(), which writes one file of about `bytes` (0 = unknown) through an AtomicFile, so that signals can end
// it, and shows its progress.
template <class Write>
void write_interruptibly(const std::string& file, std::size_t bytes, Progress& progress, const Write& write) {
  const WriteMonitor monitor([&](std::uint64_t written) {
    note_interrupts();
    std::optional<double> done;
    if (bytes > 0) done = static_cast<double>(written) / static_cast<double>(bytes);
    progress.show("writing " + file, done);
  });
  write();
}

}  // namespace occlod::tool
