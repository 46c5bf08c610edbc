// What `occlod serve` is asked for: two lines, the target of a request and its range. Whatever they say, the file
// is one of the folder, and the range lies in it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "served_files.h"

namespace occlod::tool {
namespace {

namespace fs = std::filesystem;

void expect(bool holds) {
  if (!holds) std::abort();
}

// A folder with a file, a folder, and links that stay inside and lead outside; beside it a file that is not served.
class Site {
 public:
  Site() : place_(fs::temp_directory_path() / "occlod_fuzz_XXXXXX") {
    std::string name = place_.string();
    expect(mkdtemp(name.data()) != nullptr);
    place_ = name;
    fs::create_directories(folder() / "a/b");
    std::ofstream(folder() / "tileset.json") << "{}";
    std::ofstream(folder() / "a/b/0.glb") << "glTF";
    std::ofstream(place_ / "secret") << "not served";
    fs::create_symlink("b/0.glb", folder() / "a/inside");
    fs::create_symlink("../../secret", folder() / "a/outside");
    fs::create_symlink("../..", folder() / "a/up");
  }
  ~Site() {
    std::error_code ignored;
    fs::remove_all(place_, ignored);
  }
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  [[nodiscard]] fs::path folder() const { return place_ / "site"; }
  // By its own rules: the two files, by their true names.
  [[nodiscard]] bool has(const fs::path& file) const {
    const fs::path root = fs::canonical(folder());
    return file == root / "tileset.json" || file == root / "a/b/0.glb";
  }

 private:
  fs::path place_;
};

void ask(std::string_view bytes) {
  static const Site site;
  const std::string_view target = bytes.substr(0, bytes.find('\n'));
  const std::string_view range = bytes.substr(std::min(bytes.size(), target.size() + 1));
  const std::optional<std::string> path = path_of_target(target);
  if (path) {
    expect(path->starts_with('/') && path->find('\0') == std::string::npos);
    const std::optional<fs::path> file = file_in(site.folder(), path->substr(1));
    expect(!file || site.has(*file));
  }
  for (const std::uint64_t size : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1000}, ~std::uint64_t{0}}) {
    const std::optional<ByteRange> part = range_of(range, size);
    if (!part) continue;
    expect(part->first <= size && part->size <= size - part->first);
    expect(part->size > 0 || size == 0);
  }
}

}  // namespace
}  // namespace occlod::tool

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  occlod::tool::ask({reinterpret_cast<const char*>(data), size});
  return 0;
}
