// HLODs in files. Checksums are put right first: damage by chance is found by them, what is to be found here is what a
// hostile file can do. Whatever the bytes, reading and checking all of it ends with an HLOD that can be walked, or with
// an Error; and so does opening it with meshes that come and go, which are the same. OCCLOD_FUZZ_PART: what is mutated,
// "header", "nodes" or "blobs"; anything without it.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "fuzz/memory_file.h"
#include "fuzz/section_mutator.h"
#include "fuzz/section_signer.h"
#include "hlod/store/ohlod.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "occlod/node_store.h"
#include "papers/simulated_link.h"

namespace occlod::ohlod {
namespace {

// The digests of what is packed, as far as places are inside.
void sign_packed(const fuzz::SectionSigner& file, std::string_view bytes_name, std::string_view places_name,
                 std::string_view digests_name) {
  const std::span<const std::byte> bytes = file.find<std::byte>(bytes_name);
  const std::span<const std::uint64_t> places = file.find<std::uint64_t>(places_name);
  const std::span<std::uint64_t> digests = file.find<std::uint64_t>(digests_name);
  for (std::size_t n = 0; n < digests.size() && n + 1 < places.size(); ++n)
    if (places[n] <= places[n + 1] && places[n + 1] <= bytes.size())
      digests[n] = sections::checksum_of(bytes.subspan(places[n], places[n + 1] - places[n]));
}

// The digests of all nodes, if the arrays are such that they have one.
void sign_meshes(const fuzz::SectionSigner& file) {
  hlod::HlodView view;
  const auto find = [&](std::string_view name, auto& array, bool) {
    array = file.find<typename std::decay_t<decltype(array)>::value_type>(name);
  };
  for_each_array(view, find);
  for_each_within_array(view, find);
  const std::span<Summary> summary = file.find<Summary>(summary_name);
  const std::span<std::uint64_t> digests = file.find<std::uint64_t>(digests_name);
  const std::span<std::uint64_t> splits_digests = file.find<std::uint64_t>(splits_digests_name);
  if (summary.empty()) return;
  // Whether vertices have materials that are there, the reader finds out.
  static const Material any_material;
  view.materials = {&any_material, 1};
  view.box = summary[0].box;
  view.input_triangle_count = summary[0].input_triangle_count;
  view.grouping = static_cast<hlod::Grouping>(summary[0].grouping);
  view.borders = static_cast<hlod::Borders>(summary[0].borders);
  view.has_normals = summary[0].has_normals == 1;
  view.has_colors = summary[0].has_colors == 1;
  view.has_texture_coordinates = (summary[0].wedges & has_texture_coordinates) != 0;
  view.has_materials = (summary[0].wedges & has_materials) != 0;
  view.has_seams = (summary[0].wedges & has_seams) != 0;
  if (check_structure(view) || digests.size() != view.nodes.size()) return;
  for (hlod::NodeId n = 0; n < view.nodes.size(); ++n) digests[n] = digest_of_mesh(view, n);
  if (splits_digests.size() != view.within.size()) return;
  for (hlod::NodeId n = 0; n < view.within.size(); ++n) splits_digests[n] = digest_of_splits(view, n);
}

void sign(std::vector<std::byte>& bytes) {
  fuzz::SectionSigner file(bytes, file_kind);
  file.sign([&] {
    sign_meshes(file);
    sign_packed(file, packed_meshes_name, mesh_places_name, digests_name);
    sign_packed(file, packed_splits_name, splits_places_name, splits_digests_name);
  });
}

void require(bool holds) {
  if (!holds) __builtin_trap();
}

template <typename T>
bool same_bytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

// Whether all of it is valid.
bool read(const std::filesystem::path& path, hlod::Hlod& hlod) {
  try {
    hlod = read_ohlod(path).hlod;
    hlod.require_all();
    (void)hlod::validate(hlod, 4);
    for (hlod::NodeId n = 0; n < hlod.node_count(); ++n)
      (void)hlod::within_cut(hlod, n, 0.5 * static_cast<double>(hlod.node(n).error));
  } catch (const Error&) {
    return false;
  }
  return true;
}

// Asks for the children of all nodes, frame by frame, and at last for less memory. `whole`: the same HLOD, valid; or
// null. Loads in the background come in frames that bytes decide, not threads.
void page(const hlod::Hlod& hlod, const hlod::Hlod* whole) {
  hlod::NodeStore& store = *hlod.store();
  constexpr int frames = 5;
  for (int frame = 0; frame < frames; ++frame) {
    if (frame + 1 == frames) store.set_budget(store.stats().budget_bytes / 2);  // or an Error
    store.begin_frame();
    for (hlod::NodeId n = 0; n < hlod.node_count(); ++n) {
      if (!hlod.is_resident(n)) {
        if (frame % 2 == 0) store.prefetch(n);
        continue;
      }
      store.need(n);
      if (whole != nullptr) require(same_bytes(hlod.mesh(n).positions, whole->mesh(n).positions));
      if (!store.fetch(hlod.children(n))) store.want(hlod.children(n), 1.0);
    }
    store.end_frame();
    const hlod::StoreStats stats = store.stats();
    require(stats.resident_bytes + stats.loading_bytes <= stats.budget_bytes);
    require(whole == nullptr || stats.failed == 0);
  }
}

#ifdef OCCLOD_FUZZ_PART
fuzz::SectionMutator::Part part_of(std::string_view name) {
  if (name == "header") return {true, {"INFO", "LATT", "REPO", "LEFT", "LEFN", "MATE", "TEXI"}};
  if (name == "nodes") return {false, {"NODE", "PTCH", "CHIL", "ROOT", "LEVL", "WNOD", "PMPL", "PSPP"}};
  return {false, {"MESH", "WSPL", "PMSH", "PSPL"}};
}
#endif

}  // namespace
}  // namespace occlod::ohlod

#ifdef OCCLOD_FUZZ_PART
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  static const occlod::fuzz::SectionMutator mutator(occlod::ohlod::part_of(OCCLOD_FUZZ_PART));
  return mutator.mutate({data, size}, seed) ? size : LLVMFuzzerMutate(data, size, max_size);
}
#endif

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  occlod::ohlod::sign(bytes);
  const occlod::fuzz::MemoryFile file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  occlod::hlod::Hlod whole;
  const bool is_valid = occlod::ohlod::read(file.path(), whole);
  using occlod::hlod::TrialLoad;
  struct Way {
    TrialLoad load;
    std::size_t budget;
  };
  constexpr std::size_t plenty = std::size_t{1} << 24U;
  for (const Way& way : {Way{TrialLoad::blocking, plenty}, Way{TrialLoad::blocking, size / 3},
                         Way{TrialLoad::simulated, plenty}, Way{TrialLoad::simulated, size / 2}})
    try {
      const occlod::hlod::TrialCacheOptions options{.budget_bytes = way.budget, .load = way.load};
      const occlod::hlod::Hlod paged = occlod::open_ohlod(file.path(), options.cache()).hlod;
      occlod::hlod::simulate_link(*paged.store(), options);
      occlod::ohlod::page(paged, is_valid ? &whole : nullptr);
    } catch (const occlod::Error&) {
      occlod::ohlod::require(!is_valid || way.budget < plenty);
    }
  return 0;
}
