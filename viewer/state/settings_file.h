// Stores what the viewer remembers from one run to the next.
#pragma once

#include <filesystem>

#include "session.h"

namespace occlod::viewer {

// Returns view.json in the user's config folder; empty if there is none.
[[nodiscard]] std::filesystem::path default_settings_file();

struct RememberedWindow {
  ImageSize size{1440, 900};
};

// Reads the file into the session. Returns false for a missing file, which changes nothing. Ignores unknown settings of
// newer or older versions. Throws Error for a file that is not JSON or has invalid values.
bool read_settings(const std::filesystem::path& file, Session& session, RememberedWindow& window);

// Throws Error.
void write_settings(const std::filesystem::path& file, const State& state, const RememberedWindow& window);

}  // namespace occlod::viewer
