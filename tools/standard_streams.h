// Copes with standard output and standard error that are closed or full.
#pragma once

#include <string>
#include <string_view>
#include <system_error>

#include "occlod/base.h"

namespace occlod::tool {

// Call this first in main(). If a standard stream is closed, the next file that is opened would get its number, and the
// output too. This occupies the number instead; writing to the stream still fails.
void reserve_standard_streams();

// Returns a text with control characters as in C, e.g. \n or \x1b: names from files must not steer the terminal.
[[nodiscard]] std::string printable(std::string_view text);

// Ignores failures to write to standard error, which must not end a command that does its work.
void write_to_standard_error(std::string_view text) noexcept;
// Print "occlod: error: LINE" and "occlod: note: LINE", printable.
void print_error(std::string_view line) noexcept;
void print_note(std::string_view line) noexcept;

// Flushes the result of a command, which fails when it loses its output. Throws output_error() when buffered output
// cannot be written; fmt::print() throws std::system_error when it has to write and cannot.
void flush_standard_output();
[[nodiscard]] Error output_error(std::error_code reason);

}  // namespace occlod::tool
