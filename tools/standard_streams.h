// Standard output and standard error, which may be closed or full.
#pragma once

#include <string_view>
#include <system_error>

#include "occlod/base.h"

namespace occlod::tool {

// Call first in main(). Where a standard stream is closed, its number would go to the next file that is opened, and
// what is printed into that file. Takes the number up instead; writing to the stream still fails.
void reserve_standard_streams();

// What cannot be written to standard error is lost: it must not end a command that does its work.
void write_to_standard_error(std::string_view text) noexcept;
void print_error(std::string_view line) noexcept;  // "occlod: error: LINE"
void print_note(std::string_view line) noexcept;   // "occlod: note: LINE"

// What is printed is the result: a command that loses it has failed. Throws output_error() when what is still kept back
// cannot be written; fmt::print() throws std::system_error when it has to write and cannot.
void flush_standard_output();
[[nodiscard]] Error output_error(std::error_code reason);

}  // namespace occlod::tool
