// bench_visibility: the evaluation of Birkholz & Rahn on our scenes, and what it leaves open. Prints markdown; --out
// also writes every table as CSV, all of them as one JSON file, and pictures.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/run_app.h"
#include "visibility/subjects.h"

namespace occlod::bench {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> all_scenes = {"armadillo", "armadillo_group", "planet_full", "planet_near",
                                             "sponza",    "sibenik",         "city",        "ww2_city"};

// Those of the paper's figures.
const std::vector<std::string> paper_scenes = {
    OCCLOD_BENCH_SCENES "/birkholz_rahn/armadillo.json", OCCLOD_BENCH_SCENES "/birkholz_rahn/armadillo_group.json",
    OCCLOD_BENCH_SCENES "/birkholz_rahn/planet_full.json", OCCLOD_BENCH_SCENES "/birkholz_rahn/planet_near.json"};

struct Options {
  std::vector<std::string> scenes;  // none: all_scenes or paper_scenes
  VisibilityOptions visibility;
  bool paper = false;
  bool wrongly_hidden = false;
};

// Small enough to be run by a test.
void make_quick(VisibilityOptions& options) {
  options.budgets = {500, 1'000};
  options.table_budget = 1'000;
  options.repeat = 1;
  options.share_frames = 2;
  options.views = 3;
  options.paper_views = 30;
  options.path_frames = 2;
  options.size = {160, 120};
  options.hidden_size = {96, 72};
}

// All tables as NAME.json and each as a CSV file of its own.
void write_tables(const fs::path& folder, const char* name, const std::vector<Table>& tables) {
  if (folder.empty()) return;
  tool::Json all;
  for (const Table& table : tables) {
    all[table.name] = table.rows;
    write_text(folder / (table.name + ".csv"), csv(table));
  }
  write_text(folder / (std::string(name) + ".json"), all.dump(1) + "\n");
}

// Does each subject for each scene; `finish` makes the tables from them, after every scene, so that a run that is cut
// short leaves what it has.
template <typename Finish>
void run_subjects(const Options& options, const char* name, std::vector<Subject>& subjects, const Finish& finish) {
  const VisibilityOptions& visibility = options.visibility;
  if (!visibility.out.empty()) fs::create_directories(visibility.out);
  const std::vector<std::string>& usual = options.paper ? paper_scenes : all_scenes;
  for (const std::string& scene : options.scenes.empty() ? usual : options.scenes) {
    const std::unique_ptr<SceneRun> scene_run = load_scene(scene_file(scene), visibility.size);
    if (!scene_run) continue;
    for (Subject& subject : subjects) {
      fmt::print(stderr, "{}: {}\n", scene_run->description.name, subject.table.name);
      subject.add_rows(subject.table, *scene_run, visibility);
    }
    write_tables(visibility.out, name, finish(*scene_run));
  }
}

void print_tables(const std::vector<Table>& tables) {
  for (const Table& table : tables) fmt::print("{}", markdown(table));
}

void count_wrongly_hidden(const Options& options) {
  Table views = wrongly_hidden_views();
  std::vector<Subject> subjects = {wrongly_hidden_subject(views)};
  const auto tables = [&] { return std::vector<Table>{subjects[0].table, views}; };
  run_subjects(options, "wrongly_hidden", subjects, [&](SceneRun&) { return tables(); });
  print_tables(tables());
}

void repeat_paper(const Options& options) {
  Table views = paper_views();
  std::vector<Subject> subjects = {paper_subject(options.visibility, views)};
  const Table& table_2 = subjects[0].table;
  run_subjects(options, "paper", subjects, [&](SceneRun& scene_run) {
    write_pictures(scene_run, options.visibility, Culling::subtree);
    return std::vector<Table>{table_2, paper_choices(views), views};
  });
  print_tables({table_2, paper_choices_by_scene(paper_choices(views)), paper_gains(table_2)});
}

void run(const Options& options) {
  if (options.paper) {
    repeat_paper(options);
    return;
  }
  if (options.wrongly_hidden) {
    count_wrongly_hidden(options);
    return;
  }
  const VisibilityOptions& visibility = options.visibility;
  std::vector<Subject> subjects = {meshes_subject(),
                                   table_2_subject(visibility),
                                   quality_subject(visibility),
                                   equal_error_subject(visibility),
                                   times_subject(),
                                   shares_subject(),
                                   variants_subject(visibility)};
  const Table& shares = subjects[subjects.size() - 2].table;
  const Table& variants = subjects.back().table;
  // All rows are for machines; people get the same in fewer.
  const auto for_people = [&] {
    std::vector<Table> tables = {shares_summary(shares), shares_made_smaller(shares)};
    for (Table& table : variants_by_scene(variants)) tables.push_back(std::move(table));
    return tables;
  };
  run_subjects(options, "visibility", subjects, [&](SceneRun& scene_run) {
    write_pictures(scene_run, visibility, Culling::star);
    std::vector<Table> tables = for_people();
    for (const Subject& subject : subjects) tables.push_back(subject.table);
    return tables;
  });
  for (const Subject& subject : subjects)
    if (&subject.table != &shares && &subject.table != &variants) fmt::print("{}", markdown(subject.table));
  print_tables(for_people());
}

void add_options(CLI::App& app, Options& options) {
  VisibilityOptions& visibility = options.visibility;
  app.add_option("--scene", options.scenes,
                 fmt::format("Shipped scenes by name, or scene files; if none is given {}, with --paper those of "
                             "bench/scenes/birkholz_rahn",
                             fmt::join(all_scenes, ", ")));
  app.add_option("--budget", visibility.budgets, "Triangles, for shares and times")->capture_default_str();
  app.add_option("--out", visibility.out, "Folder for CSV, JSON and pictures");
  add_repeat_option(app, visibility.repeat, "Rounds");
  app.add_option("--frames", visibility.share_frames, "Frames of each path at most, for shares")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--views", visibility.views, "Random views of each scene, for --wrongly-hidden")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_flag(
      "--paper", options.paper,
      "Repeat the experiment of Birkholz & Rahn instead: in views like those of its figures, and in random ones "
      "that are as difficult");
  app.add_flag("--wrongly-hidden", options.wrongly_hidden,
               "Count wrongly hidden pixels over many views instead: takes minutes a scene");
  app.add_flag_callback(
         "--quick", [&visibility] { make_quick(visibility); }, "Small pictures and budgets, one round: for tests")
      ->trigger_on_parse();
}

int run(int argc, char** argv) {
  CLI::App app("Where triangles go without and with occlusion, after Birkholz & Rahn.", "bench_visibility");
  Options options;
  add_options(app, options);
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
