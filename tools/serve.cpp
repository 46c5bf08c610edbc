// Implements `occlod serve FOLDER`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "commands.h"
#include "file_server.h"
#include "global_options.h"
#include "occlod/base.h"
#include "option_values.h"
#include "tiles_page.h"

namespace occlod::tool {
namespace {

constexpr std::uint64_t largest_port = 65535;

struct Options {
  std::string folder;
  std::string cesium;
  std::string host = "127.0.0.1";
  std::uint16_t port = 8080;
};

void require_file(const std::string& folder, const std::string& name, const std::string& remedy) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(std::filesystem::path(folder) / name, error))
    throw Error({folder, "", "has no " + name, remedy});
}

void run(const Options& options) {
  if (std::error_code unknown; std::filesystem::is_regular_file(options.folder, unknown))
    throw Error({options.folder, "", "is a file, and a tileset is served from a folder",
                 "unpack an archive with 'unzip', or write the tileset as a folder"});
  require_file(options.folder, "tileset.json", "make a tileset with 'occlod tiles'");
  if (!options.cesium.empty())
    require_file(options.cesium, "Cesium.js", "name the folder Build/Cesium of the package cesium");
  ServerOptions server;
  server.host = options.host;
  server.port = options.port;
  server.folders = {{"/tileset/", options.folder}};
  if (options.cesium.empty()) {
    server.page =
        tiles_page(fmt::format("https://cesium.com/downloads/cesiumjs/releases/{}/Build/Cesium/", cesium_version));
  } else {
    server.page = tiles_page("/cesium/");
    server.folders.push_back({"/cesium/", options.cesium});
  }
  serve(server, [&](std::uint16_t port) {
    const bool is_ipv6 = options.host.find(':') != std::string::npos;
    fmt::print("http://{}:{}/\n", is_ipv6 ? "[" + options.host + "]" : options.host, port);
    std::fflush(stdout);
  });
}

}  // namespace

void add_serve(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("serve", "Show a tileset in a browser, until Ctrl-C");
  const auto options = std::make_shared<Options>();
  add_file(command, "FOLDER", options->folder, "A tileset, with a tileset.json")->required();
  command
      .add_option(
          "--host", options->host,
          "Address of this machine on which to answer, in numbers; 0.0.0.0: all, for browsers of other machines")
      ->transform(not_empty())
      ->type_name("ADDRESS")
      ->capture_default_str();
  add_number(command, "--port", options->port, WholeRange{0, largest_port}, "0: any that is free")
      ->capture_default_str();
  add_file(
      command, "--cesium", options->cesium,
      fmt::format("Folder Build/Cesium of the npm package cesium; without, the page loads CesiumJS {} from cesium.com",
                  cesium_version))
      ->type_name("FOLDER");
  command.callback([options, &command] {
    read_global_options(command, {});
    run(*options);
  });
}

}  // namespace occlod::tool
