#include "session_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "io/atomic_file.h"
#include "occlod/core/error.h"

namespace occlod::viewer {
namespace {

namespace fs = std::filesystem;

const char* name_of(OutputKind kind) {
  switch (kind) {
    case OutputKind::scene:
      return "a scene";
    case OutputKind::picture:
      return "a picture";
    case OutputKind::numbers:
      return "a table";
  }
  return "";
}

fs::path without_links(const fs::path& file) {
  std::error_code ignored;
  try {
    return fs::weakly_canonical(fs::absolute(AtomicFile::target_of(file), ignored), ignored);
  } catch (const Error&) {  // links that lead nowhere: whoever writes the file will say so
    return file;
  }
}

}  // namespace

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code missing;
  if (fs::equivalent(a, b, missing)) return true;
  return !fs::exists(a, missing) && !fs::exists(b, missing) && without_links(a) == without_links(b);
}

void SessionFiles::add_input(const fs::path& file, const std::string& what) { inputs_.push_back({file, what, false}); }
void SessionFiles::add_scene(const fs::path& file) { inputs_.push_back({file, "a scene that was opened", true}); }

fs::path SessionFiles::output(const JsonPlace& place, OutputKind kind, const Objects& objects) {
  const fs::path file = place.string();
  add_outputs(place, {file}, kind, objects);
  return file;
}

void SessionFiles::add_outputs(const JsonPlace& place, const std::vector<fs::path>& files, OutputKind kind,
                               const Objects& objects) {
  for (const fs::path& file : files)
    if (const std::string what = conflict(file, kind, objects); !what.empty())
      place.fail(fmt::format("{} is {} and is not overwritten", file.string(), what), "choose another name");
  for (const fs::path& file : files) {
    const auto is_it = [&](const Written& written) { return is_same_file(written.file, file); };
    if (std::none_of(outputs_.begin(), outputs_.end(), is_it)) outputs_.push_back({fs::absolute(file), kind});
  }
}

std::string SessionFiles::conflict(const fs::path& file, OutputKind kind, const Objects& objects) const {
  for (const PlacedObject& object : objects)
    if (const auto* mesh = std::get_if<MeshFile>(&object.source))
      for (const std::string& name : mesh->names)
        if (is_same_file(name, file)) return fmt::format("the file of the open object \"{}\"", object.name);
  for (const Used& input : inputs_)
    if (is_same_file(input.file, file) && !(input.is_scene && kind == OutputKind::scene)) return input.what;
  for (const Written& output : outputs_)
    if (output.kind != kind && is_same_file(output.file, file))
      return fmt::format("{} that was written before", name_of(output.kind));
  return "";
}

}  // namespace occlod::viewer
