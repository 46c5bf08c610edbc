#include "cells/vlod_format.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>

#include "base/option_checker.h"
#include "mesh/section_file.h"
#include "occlod/base.h"
#include "splits/olod.h"

namespace occlod::vlod {
namespace {

constexpr int max_sampled_eyes = 64;  // along each axis, as in CellBuilder

class Hash {
 public:
  Hash() : state_(XXH3_createState(), &XXH3_freeState) {
    if (!state_) throw std::bad_alloc();
    XXH3_128bits_reset(state_.get());
  }
  template <typename T>
  void add(std::span<const T> values) {
    const std::uint64_t count = values.size();
    XXH3_128bits_update(state_.get(), &count, sizeof(count));
    XXH3_128bits_update(state_.get(), values.data(), values.size_bytes());
  }
  template <typename T>
  void add_one(const T& value) {
    add(std::span<const T>(&value, 1));
  }
  [[nodiscard]] Key value() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return {hash.low64, hash.high64};
  }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

// Adds wedges and materials of a hierarchy to the hash.
void add_wedges(const HierarchyView& view, Hash& hash) {
  olod::for_each_wedge_array(view, [&](std::string_view, const auto& array, bool) { hash.add(array); });
  const auto add_text = [&](const std::string& text) { hash.add(std::span<const char>(text)); };
  for (const Material& material : view.materials) {
    add_text(material.name);
    hash.add_one(material.base_color);
    hash.add_one(material.texture);
    if (material.surface != Surface{}) add_text(sections::text_of(material.surface));
  }
  for (const Texture& texture : view.textures) {
    add_text(texture.file);
    add_text(texture.mime_type);
    hash.add(std::span<const std::uint8_t>(texture.bytes));
    hash.add_one(static_cast<std::uint32_t>(texture.wrap_s));
    hash.add_one(static_cast<std::uint32_t>(texture.wrap_t));
    if (texture.min_filter != 0 || texture.mag_filter != 0) {
      hash.add_one(texture.min_filter);
      hash.add_one(texture.mag_filter);
    }
  }
  hash.add_one(static_cast<std::uint32_t>(view.texture_origin));
}

Key hash_of(const Hierarchy& hierarchy) {
  hierarchy.require_all();
  const HierarchyView& view = hierarchy.data();
  Hash hash;
  olod::for_each_array(view, [&](std::string_view, const auto& array, bool) { hash.add(array); });
  hash.add_one(view.error_bound);
  if (olod::needs_wedges(view)) add_wedges(view, hash);
  return hash.value();
}

}  // namespace

std::vector<StoredObject> describe(std::span<const RefineObject> objects) {
  std::vector<StoredObject> described;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const RefineObject& object = objects[i];
    StoredObject& it = described.emplace_back();
    // Objects often share a hierarchy, so look for an earlier description.
    const auto same = std::find_if(objects.begin(), objects.begin() + static_cast<std::ptrdiff_t>(i),
                                   [&](const RefineObject& other) { return other.hierarchy == object.hierarchy; });
    const auto earlier = static_cast<std::size_t>(same - objects.begin());
    it.hierarchy = earlier < i ? described[earlier].hierarchy : hash_of(*object.hierarchy);
    it.split_count = static_cast<std::uint32_t>(object.hierarchy->split_count());
    it.two_sided = object.two_sided ? 1 : 0;
    it.ignores_attributes = !object.attributes && !object.hierarchy->data().attribute_errors.empty() ? 1 : 0;
    it.object_to_world = object.object_to_world;
  }
  return described;
}

StoredOptions store(const Scene& scene) {
  const CellTreeOptions& options = scene.options;
  const EyeModel& eyes = options.cell.eyes;
  StoredOptions stored;
  stored.epoch = epoch;
  stored.division = static_cast<std::uint32_t>(options.division);
  stored.levels = scene.levels;
  stored.focal_length_px = eyes.focal_length_px;
  stored.cos_corner_angle = eyes.cos_corner_angle;
  stored.near = eyes.near;
  stored.clearance = eyes.clearance;
  stored.tolerance_px = options.cell.tolerance_px;
  stored.occlusion = static_cast<std::uint32_t>(options.cell.occlusion);
  stored.budget = options.cell.budget;
  stored.sampled_eyes = static_cast<std::uint64_t>(options.cell.sampled_eyes);
  stored.root_cell = options.root_cell;
  stored.smallest_cell = options.smallest_cell;
  stored.occluder_motion = options.occluder_motion.value_or(options.smallest_cell / 4.0);
  stored.max_triangles = options.max_triangles;
  Hash hash;
  hash.add_one(stored);
  hash.add(std::span<const CellBox>(options.regions));
  hash.add(std::span<const StoredObject>(scene.objects));
  stored.key = hash.value();
  return stored;
}

CellTreeOptions restore(const StoredOptions& stored, std::span<const CellBox> regions) {
  CellTreeOptions options;
  options.cell.eyes = {stored.focal_length_px, stored.cos_corner_angle, stored.near, stored.clearance};
  options.cell.tolerance_px = stored.tolerance_px;
  options.cell.occlusion = static_cast<CellOcclusion>(stored.occlusion);
  options.cell.budget = stored.budget;
  options.cell.sampled_eyes = static_cast<int>(std::min<std::uint64_t>(stored.sampled_eyes, max_sampled_eyes + 1));
  options.regions.assign(regions.begin(), regions.end());
  options.root_cell = stored.root_cell;
  options.smallest_cell = stored.smallest_cell;
  options.max_triangles = stored.max_triangles;
  options.division = static_cast<CellDivision>(stored.division);
  options.occluder_motion = stored.occluder_motion;
  return options;
}

Scene read_options(sections::SectionReader& reader, const std::string& subject, Key& key) {
  const auto stored = reader.read_one<StoredOptions>(options_name, "set of options");
  if (stored.epoch != epoch)
    reader.refuse("section OPTS",
                  fmt::format("cells were made in way {}, this program makes them in way {}", stored.epoch, epoch));
  Scene scene{restore(stored, reader.read<CellBox>(regions_name)), {}, stored.levels};
  check(scene.options, subject.c_str());
  const std::span<const StoredObject> objects = reader.read<StoredObject>(objects_name);
  scene.objects.assign(objects.begin(), objects.end());
  key = stored.key;
  if (store(scene).key != key) reader.refuse("section OPTS", "has a key that is not its own");
  return scene;
}

void check(const CellTreeOptions& options, const char* subject) {
  const OptionChecker checker(subject);
  checker.positive("tolerance_px", options.cell.tolerance_px);
  checker.in_range("sampled_eyes", options.cell.sampled_eyes, 1, max_sampled_eyes);
  if (options.cell.occlusion != CellOcclusion::none && options.cell.occlusion != CellOcclusion::hull &&
      options.cell.occlusion != CellOcclusion::sampled)
    throw Error({subject, "occlusion", "is unknown", "use a newer program"});
  checker.positive("root_cell", options.root_cell);
  checker.positive("smallest_cell", options.smallest_cell);
  if (options.occluder_motion) checker.at_least("occluder_motion", *options.occluder_motion, 0.0);
  if (options.division != CellDivision::halving && options.division != CellDivision::gain)
    throw Error({subject, "division", "is unknown", "use a newer program"});
  if (options.regions.empty()) throw Error({subject, "regions", "there is none", "say where the eye may be"});
  // Throws for eyes and regions that are out of their range.
  for (const CellBox& region : options.regions) static_cast<void>(CellView(region, options.cell.eyes, glm::dmat4(1.0)));
}

GlobalIds::GlobalIds(std::span<const StoredObject> objects, const std::string& subject) : first_{0} {
  for (const StoredObject& object : objects) first_.push_back(first_.back() + object.split_count);
  if (owner_count() >> 32U != 0)
    throw Error({subject, "objects", "together have 2^32 splits or more", "leave objects out"});
}

GlobalIds::Place GlobalIds::place_of_split(std::uint64_t split) const {
  const auto object = std::upper_bound(first_.begin(), first_.end(), split) - first_.begin() - 1;
  return {static_cast<std::uint32_t>(object), static_cast<SplitId>(split - first_[static_cast<std::size_t>(object)])};
}

GlobalIds::Place GlobalIds::place_of_owner(std::uint64_t owner) const {
  // Owners of object i begin at first_[i] + i.
  std::size_t low = 0, high = first_.size() - 1;
  while (low + 1 < high) {
    const std::size_t middle = (low + high) / 2;
    (first_[middle] + middle <= owner ? low : high) = middle;
  }
  const std::uint64_t within = owner - first_[low] - low;
  return {static_cast<std::uint32_t>(low), within == 0 ? no_id : static_cast<SplitId>(within - 1)};
}

}  // namespace occlod::vlod
