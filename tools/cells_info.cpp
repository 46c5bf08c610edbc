// Implements `occlod cells info FILE.vlod`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cells.h"
#include "global_options.h"
#include "occlod/base.h"
#include "option_values.h"

namespace occlod::tool {
namespace {

struct Options {
  std::filesystem::path file;
  bool all = false;
  std::optional<std::uint64_t> cell;
  std::optional<glm::dvec3> eye;
  bool json = false;
};

// Reads all nodes below `cell`. `path` holds what those above it add.
void check_below(const VlodFile& file, CellId cell, std::vector<const CellAdditions*>& path) {
  const CellAdditions additions = file.read(cell, path);
  path.push_back(&additions);
  for (CellId child = cell + 1; child < file.tree().node(cell).end; child = file.tree().node(child).end)
    check_below(file, child, path);
  path.pop_back();
}

// Reads the geometry of all cells of a packed file.
void check_geometry(const VlodFile& file) {
  for (CellId n = 0; n < file.tree().nodes().size(); ++n)
    if (file.tree().is_leaf(n)) static_cast<void>(read_cell(file, n));
}

CellId chosen_cell(const Options& options, const CellTree& tree) {
  if (options.cell) {
    if (*options.cell < tree.nodes().size()) return static_cast<CellId>(*options.cell);
    throw Error({options.file.string(), "--cell", fmt::format("it has {} nodes, numbered from 0", tree.nodes().size()),
                 "give one of them"});
  }
  const CellId leaf = tree.leaf_of(*options.eye);
  if (leaf == no_id)
    throw Error({options.file.string(), "--cell", "no cell holds this point", "give a point in one of its regions"});
  return leaf;
}

void choose_cell(Options& options, const std::string& text) {
  if (const auto point = numbers_in(text, 3)) {
    options.eye = {(*point)[0], (*point)[1], (*point)[2]};
    return;
  }
  options.cell = whole_number(text);
  if (!options.cell || *options.cell > max_elements)
    throw CLI::ValidationError(
        "--cell", fmt::format("{} is not a whole number from 0 to {}, or X,Y,Z: three finite numbers", shown(text),
                              max_elements));
}

// Describes what is drawn in a cell, or shared by all cells below a node.
Json cell_to_json(const VlodFile& file, CellId cell) {
  const CellTree& tree = file.tree();
  const CellNode& node = tree.node(cell);
  std::vector<CellId> path, neighbours;
  tree.path_to(cell, path);
  std::uint64_t bytes = 0, splits = 0, hidden = 0;
  Json nodes = Json::array();
  for (const CellId n : path) {
    const CellNode& above = tree.node(n);
    bytes += above.payload_bytes;
    splits += above.splits;
    hidden += above.hidden_faces;
    nodes.push_back(
        {{"node", n}, {"splits", above.splits}, {"hidden_faces", above.hidden_faces}, {"bytes", above.payload_bytes}});
  }
  Json told = {{"cell", cell},
               {"is_leaf", tree.is_leaf(cell)},
               {"min", to_json(node.box.min)},
               {"max", to_json(node.box.max)},
               {"splits", splits},
               {"hidden_faces", hidden},
               {"path_bytes", bytes}};
  if (tree.is_leaf(cell)) {
    told["triangles"] = node.triangles;
    told["drawn_triangles"] = node.drawn_triangles;
    told["error_px"] = node.error_px;
    tree.neighbours(cell, neighbours);
    told["neighbours"] = neighbours;
  }
  told["path"] = nodes;
  return told;
}

void run(const Options& options) {
  const auto file = open_vlod(options.file);
  std::vector<const CellAdditions*> path;
  if (options.all) check_below(*file, 0, path);
  if (options.all && file->is_packed()) check_geometry(*file);
  Json result = {{"file", options.file.string()}, {"format", file->version()}};
  if (options.cell || options.eye)
    result.update(cell_to_json(*file, chosen_cell(options, file->tree())));
  else
    result.update(to_json(*file));
  if (options.json) return print_json(result);
  print_lines(result);
}

}  // namespace

void add_cells_info(CLI::App& cells) {
  CLI::App& command = *cells.add_subcommand("info", "Describe a .vlod file, or one of its cells");
  const auto options = std::make_shared<Options>();
  add_file(command, "FILE", options->file, "A .vlod file")->required();
  command.add_flag("--all", options->all, "Read and check what all cells draw too");
  command
      .add_option_function<std::string>(
          "--cell", [options](const std::string& text) { choose_cell(*options, text); },
          "Describe this node of the tree of cells, or the cell that holds this point")
      ->type_name("ID|X,Y,Z");
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json});
    run(*options);
  });
}

}  // namespace occlod::tool
