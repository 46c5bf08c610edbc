// What the viewer remembers from one run to the next.
#pragma once

#include <filesystem>

#include "session.h"

namespace occlod::viewer {

// view.json in the user's config folder; empty when there is none.
[[nodiscard]] std::filesystem::path default_settings_file();

struct RememberedWindow {
  ImageSize size{1440, 900};
};

// Reads what is there into the session; false for a missing file, which changes nothing. What a newer or older version
// wrote and this one does not know is left out. Throws Error for a file that is no JSON or has values that do not fit.
bool read_settings(const std::filesystem::path& file, Session& session, RememberedWindow& window);

// Throws Error.
void write_settings(const std::filesystem::path& file, const State& state, const RememberedWindow& window);

}  // namespace occlod::viewer
