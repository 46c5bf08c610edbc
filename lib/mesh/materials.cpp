#include "mesh/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/text.h"

namespace occlod {
namespace {

// Takes words from the front of a line.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) { skip_blanks(); }

  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] std::string_view front() const { return rest_.substr(0, rest_.find_first_of(" \t")); }
  std::string_view take() {
    const std::string_view word = front();
    rest_.remove_prefix(word.size());
    skip_blanks();
    return word;
  }

 private:
  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t"), rest_.size())); }

  std::string_view rest_;
};

bool is_number(std::string_view word) {
  double value = 0.0;
  const char* const first = word.data() + (word.starts_with('+') ? 1 : 0);
  const char* const last = word.data() + word.size();
  return first != last && parse_double(first, last, value).ptr == last;
}

// Reads a number; returns false when the word is none or exceeds the range of double.
bool read_number(std::string_view word, double& value) {
  const char* const first = word.data() + (word.starts_with('+') ? 1 : 0);
  return is_number(word) && parse_double(first, word.data() + word.size(), value).ec == std::errc{};
}

// An option of a map_ line and the number of words after it; all words but the first may be missing if they are
// numbers.
struct MapOption {
  std::string_view name;
  int words;
};
constexpr std::array<MapOption, 13> map_options{{{"-blendu", 1},
                                                 {"-blendv", 1},
                                                 {"-boost", 1},
                                                 {"-bm", 1},
                                                 {"-cc", 1},
                                                 {"-clamp", 1},
                                                 {"-imfchan", 1},
                                                 {"-mm", 2},
                                                 {"-o", 3},
                                                 {"-s", 3},
                                                 {"-t", 3},
                                                 {"-texres", 1},
                                                 {"-type", 1}}};

std::string_view without_quotes(std::string_view name) {
  if (!name.starts_with('"')) return name;
  name.remove_prefix(1);
  return name.substr(0, name.find('"'));
}

class MtlParser {
 public:
  MtlParser(std::string_view text, const FileErrors& errors)
      : cursor_(text, errors, {.hash_comments = true, .backslash_continues = true}) {}

  std::vector<MtlMaterial> parse() && {
    for (; cursor_.find_word(); cursor_.skip_line()) {
      const std::string_view keyword = cursor_.word();
      if (equal_ignoring_case(keyword, "newmtl"))
        begin_material();
      else if (equal_ignoring_case(keyword, "Kd"))
        read_base_color();
      else if (equal_ignoring_case(keyword, "Ke"))
        read_emission();
      else if (equal_ignoring_case(keyword, "d"))
        read_dissolve();
      else if (equal_ignoring_case(keyword, "Tr"))
        read_transparency();
      else if (equal_ignoring_case(keyword, "Pr"))
        current().material.surface.roughness = unit(number(cursor_.word()));
      else if (equal_ignoring_case(keyword, "Pm"))
        current().material.surface.metallic = unit(number(cursor_.word()));
      else if (equal_ignoring_case(keyword, "map_Kd"))
        current().color = read_map("map_Kd");
      else if (equal_ignoring_case(keyword, "norm"))
        current().normals = read_map("norm");
      else if (equal_ignoring_case(keyword, "map_Ke"))
        read_map_of_emission();
      else
        leave_out(keyword);
    }
    return std::move(materials_);
  }

 private:
  void begin_material() {
    materials_.push_back({.material = {.name = std::string(cursor_.rest_of_line())}});
    materials_.back().left_out = std::exchange(before_first_, {});
    has_dissolve_ = has_emission_ = false;
  }

  MtlMaterial& current() {
    if (materials_.empty()) cursor_.fail("comes before the first newmtl", "export the materials again");
    return materials_.back();
  }

  // Counts what stands before the first material with that one.
  void leave_out(std::string_view what) { (materials_.empty() ? before_first_ : materials_.back().left_out).add(what); }

  void read_base_color() {
    glm::vec4& color = current().material.base_color;
    if (const auto read = read_color("Kd")) color = glm::vec4(*read, color.a);
  }

  void read_emission() {
    glm::vec3& emissive = current().material.surface.emissive;
    const auto read = read_color("Ke");
    if (!read) return;
    emissive = *read;
    has_emission_ = true;
  }

  void read_map_of_emission() {
    MtlMaterial& material = current();
    material.emission = read_map("map_Ke");
    if (!has_emission_ && !material.emission.texture.file.empty()) material.material.surface.emissive = glm::vec3(1.0F);
  }

  // Reads "r [g b]" of sRGB as linear light; spectral curves are not followed and CIE XYZ is not converted: both are
  // nothing here.
  std::optional<glm::vec3> read_color(std::string_view keyword) {
    const std::string_view line = cursor_.rest_of_line();
    for (const char* const kind : {"spectral", "xyz"}) {
      if (!line.starts_with(kind)) continue;
      leave_out(fmt::format("{} {}", keyword, kind));
      return std::nullopt;
    }
    Words words(line);
    std::array<double, 3> color{};
    int count = 0;
    for (; count < 3 && !words.rest().empty() && words.rest()[0] != '#'; ++count)
      color[static_cast<std::size_t>(count)] = number(words.take());
    if (count == 0)
      cursor_.fail(fmt::format("{} has no colour", keyword), "complete the line or export the materials again");
    if (count < 3) color[1] = color[2] = color[0];
    if (keyword == "Ke" && std::ranges::any_of(color, [](double c) { return c > 1.0; }))
      leave_out("Ke above 1 (clamped)");
    glm::vec3 linear;
    for (std::size_t i = 0; i < 3; ++i) linear[static_cast<int>(i)] = static_cast<float>(srgb_to_linear(color[i]));
    return linear;
  }

  // Reads "[-halo] opacity".
  void read_dissolve() {
    Words words(cursor_.rest_of_line());
    if (words.front() == "-halo") {
      words.take();
      leave_out("d -halo");
    }
    current().material.base_color.a = unit(number(words.take()));
    has_dissolve_ = true;
  }

  // Reads "[options] file", where the name of the file may contain blanks.
  MtlMap read_map(std::string_view keyword) {
    auto [texture, placement] = MtlMap{};
    Words words(cursor_.rest_of_line());
    for (;;) {
      const auto option = std::ranges::find(map_options, words.front(), &MapOption::name);
      if (option == map_options.end()) break;
      words.take();
      if (option->name == "-o") placement.offset = take_pair(option->name, words, 0.0);
      if (option->name == "-s") placement.scale = take_pair(option->name, words, 1.0);
      if (option->name == "-o" || option->name == "-s") continue;
      if (option->name != "-clamp") leave_out(fmt::format("{} {}", keyword, option->name));
      if (option->name == "-clamp" && words.front() == "on") texture.wrap_s = texture.wrap_t = TextureWrap::clamp;
      words.take();
      for (int i = 1; i < option->words && is_number(words.front()); ++i) words.take();
    }
    texture.file = without_quotes(words.rest());
    return {std::move(texture), placement};
  }

  // Reads "u [v [w]]"; w is for textures in three dimensions.
  glm::dvec2 take_pair(std::string_view option, Words& words, double missing) const {
    glm::dvec2 pair(missing);
    for (int i = 0; i < 3 && (i == 0 || is_number(words.front())); ++i) {
      const std::string_view word = words.take();
      double value = 0.0;
      if (!read_number(word, value) || !std::isfinite(value))
        cursor_.fail(std::string(option) + " of a texture is " + in_quotes(word) + ", which is not a finite number",
                     "correct the line or export the materials again");
      if (i < 2) pair[i] = value;
    }
    return pair;
  }

  // Reads Tr, which is 1 - d. Some programs write Tr 1 beside d 1 for opaque materials.
  void read_transparency() {
    Words words(cursor_.rest_of_line());
    Material& material = current().material;
    const double transparency = number(words.take());
    if (!has_dissolve_) material.base_color.a = unit(1.0 - transparency);
  }

  static float unit(double value) { return value > 0.0 ? static_cast<float>(std::min(value, 1.0)) : 0.0F; }

  double number(std::string_view word) {
    double value = 0.0;
    if (!read_number(word, value))
      cursor_.fail("a value of a material is " + in_quotes(word) + ", which is not a number",
                   "correct the line or export the materials again");
    return value;
  }

  TextCursor cursor_;
  std::vector<MtlMaterial> materials_;
  LeftOut before_first_;
  bool has_dissolve_ = false;  // true when the current material has d
  bool has_emission_ = false;  // true when it has Ke
};

}  // namespace

std::vector<MtlMaterial> parse_mtl(std::string_view text, const FileErrors& errors) {
  return MtlParser(text, errors).parse();
}

}  // namespace occlod
