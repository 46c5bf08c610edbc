// What a recording holds, in memory and in its file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/section_file.h"
#include "occlod/device.h"

namespace occlod::hlod {

enum class Call : std::uint32_t { begin_frame, draw, ask, ask_each, available, wait, visit, end_frame };
inline constexpr std::uint32_t call_count = 8;

// One call, in the order in which they were made.
struct RecordedCall {
  std::uint64_t digest = 0;  // of its arguments, see call_digest.h
  Call call = Call::begin_frame;
  std::uint32_t query = 0;  // of ask, ask_each, available and wait
  std::uint32_t count = 0;  // counts of ask, ask_each and wait; what available said, 0 or 1; else 0
  std::uint32_t reserved = 0;
};
static_assert(sizeof(RecordedCall) == 24);
static_assert(sizeof(FrameTimes) == 40);

struct RecordingData {
  std::string device;
  std::vector<RecordedCall> calls;    // whole frames, from begin_frame to end_frame
  std::vector<std::uint32_t> counts;  // of all calls of wait
  std::vector<FrameTimes> times;      // by frame
};

// What contradicts itself, or nothing: frames that are not whole, answers to queries that were not asked, counts and
// times that are not as many as the calls need. O(calls).
[[nodiscard]] std::optional<std::string> check_recording(const RecordingData& data);

inline constexpr sections::FileKind recording_kind{
    {'O', 'R', 'E', 'C', '\r', '\n', '\x1a', '\n'}, 1, ".orec", "record one", "record it again"};
inline constexpr std::string_view calls_name = "CALL", counts_name = "CNTS", times_name = "TIME", device_name = "NAME";

}  // namespace occlod::hlod
