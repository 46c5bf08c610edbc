// What the system says about files by signals that end a program without a word.
#pragma once

#include <string_view>

namespace occlod::tool {

// From now on, once a process:
// - SIGBUS for a page of a mapped file that is gone, since the file was cut short or its disk failed, prints one line
//   "PROGRAM: error: FILE: ..." and ends the process with 1. A file that is being written stays as it was; its
//   half-written neighbour is left to the next AtomicFile. Other causes end the process as ever.
// - SIGXFSZ is ignored: writing more than the limit of file sizes fails, as on a full disk.
void handle_file_faults(std::string_view program);

}  // namespace occlod::tool
