// Reports errors of files that the system signals by ending a program silently.
#pragma once

#include <string_view>

namespace occlod::tool {

// Must be called once per process. Afterwards:
// - SIGBUS for a page of a mapped file that is gone, since the file was truncated or its disk failed, prints one line
// "PROGRAM: error: FILE: ..." and ends the process with 1. A file that is being written stays unchanged; its
// half-written neighbour is left to the next AtomicFile. Other causes end the process as usual.
// - SIGXFSZ is ignored: writing beyond the limit of file sizes fails, as on a full disk.
void handle_file_faults(std::string_view program);

}  // namespace occlod::tool
