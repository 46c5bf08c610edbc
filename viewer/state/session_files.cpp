#include "session_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "occlod/base.h"
#include "scene/named_files.h"

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
    case OutputKind::mesh:
      return "a mesh";
  }
  return "";
}

}  // namespace

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
    const auto is_it = [&](const Written& written) { return identity_of(written.file) == identity_of(file); };
    if (std::none_of(outputs_.begin(), outputs_.end(), is_it)) outputs_.push_back({fs::absolute(file), kind});
  }
}

std::string SessionFiles::conflict(const fs::path& file, OutputKind kind, const Objects& objects) const {
  const std::string identity = identity_of(file);
  for (const PlacedObject& object : objects)
    for (const SceneObject& part : object.parts)
      if (const auto* mesh = std::get_if<MeshFile>(&part.source))
        for (const std::string& name : mesh->names)
          if (identity_of(name) == identity) return fmt::format("the file of the open object \"{}\"", object.name);
  std::error_code unknown;
  if (fs::exists(file, unknown))
    for (const PlacedObject& object : objects)
      for (const SceneObject& part : object.parts)
        if (const auto* mesh = std::get_if<MeshFile>(&part.source))
          for (const std::string& name : mesh->names)
            for (const NamedFile& named : files_named_by(name))
              if (identity_of(named.path) == identity) return named.role;
  for (const Used& input : inputs_)
    if (identity_of(input.file) == identity && !(input.is_scene && kind == OutputKind::scene)) return input.what;
  for (const Written& output : outputs_)
    if (output.kind != kind && identity_of(output.file) == identity)
      return fmt::format("{} that was written before", name_of(output.kind));
  return "";
}

}  // namespace occlod::viewer
