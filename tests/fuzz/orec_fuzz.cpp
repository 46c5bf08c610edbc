// Recordings in files. Checksums are put right first: damage by chance is found by them, what is to be found here is
// what a hostile file can do. Whatever the bytes, reading ends with an Error or with a recording that can be replayed
// from beginning to end, and written again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "fuzz/memory_file.h"
#include "fuzz/section_signer.h"
#include "occlod/base.h"
#include "papers/recorded_device.h"
#include "papers/trial_devices.h"

namespace occlod::hlod {
namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

// What a replay relies on, by its own count.
void walk(const RecordingData& data) {
  std::uint64_t counts = 0, frames = 0;
  for (const RecordedCall& call : data.calls) {
    require(static_cast<std::uint32_t>(call.call) < call_count);
    require(frames < data.times.size());
    if (call.call == Call::wait) counts += call.count;
    require(counts <= data.counts.size());
    if (call.call == Call::end_frame) ++frames;
  }
  require(frames == data.times.size() && counts == data.counts.size());
  require(data.calls.empty() || data.calls.front().call == Call::begin_frame);
  ReplayingDevice replay{Recording(std::make_shared<const RecordingData>(data))};
  try {
    replay.visit(1);
    std::abort();  // no frame begins with that
  } catch (const Error&) {
    return;
  }
}

}  // namespace
}  // namespace occlod::hlod

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  occlod::fuzz::SectionSigner(bytes, occlod::hlod::recording_kind).sign([] {});
  const occlod::fuzz::MemoryFile file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  try {
    occlod::hlod::walk(*occlod::hlod::read_recording(file.path()).data());
  } catch (const occlod::Error&) {
    return 0;  // refused
  }
  return 0;
}
