// Copes with standard output and standard error that are closed or full.
#pragma once

#include <string_view>
#include <system_error>

#include "occlod/base.h"

namespace occlod::tool {

// Call this first in main(). If a standard stream is closed, the next file that is opened would get its number, and the
// output too. This occupies the number instead; writing to the stream still fails.
void reserve_standard_streams();

// Ignores failures to write to standard error, which must not end a command that does its work.
void write_to_standard_error(std::string_view text) noexcept;
void print_error(std::string_view line) noexcept;  // "occlod: error: LINE"
void print_note(std::string_view line) noexcept;   // "occlod: note: LINE"

// Flushes the result of a command, which fails when it loses its output. Throws output_error() when buffered output
// cannot be written; fmt::print() throws std::system_error when it has to write and cannot.
void flush_standard_output();
[[nodiscard]] Error output_error(std::error_code reason);

}  // namespace occlod::tool
