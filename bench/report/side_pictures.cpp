#include "report/side_pictures.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include "report/setting_run.h"

namespace occlod::bench {
namespace {

std::size_t at(const Image& image, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
}

struct Corner {
  int x = 0;
  int y = 0;
};

// Sums over all upper left parts: of width x height pixels at [height * stride + width].
struct SumTable {
  std::size_t stride;
  std::vector<double> sums;

  SumTable(const Image& a, const Image& b)
      : stride(static_cast<std::size_t>(a.width) + 1), sums(stride * (static_cast<std::size_t>(a.height) + 1), 0.0) {
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x) {
        const glm::u8vec4 p = a.pixels[at(a, x, y)], q = b.pixels[at(b, x, y)];
        const int difference = std::abs(p.x - q.x) + std::abs(p.y - q.y) + std::abs(p.z - q.z);
        sums[place(x + 1, y + 1)] = difference + sums[place(x, y + 1)] + sums[place(x + 1, y)] - sums[place(x, y)];
      }
  }

  [[nodiscard]] std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x);
  }
  [[nodiscard]] double of(const Corner& corner, const tool::ImageSize& part) const {
    const int right = corner.x + part.width, bottom = corner.y + part.height;
    return sums[place(right, bottom)] - sums[place(corner.x, bottom)] - sums[place(right, corner.y)] +
           sums[place(corner.x, corner.y)];
  }
};

// Of the part with the largest sum of differences, to a grid of 16 pixels.
Corner most_different(const Image& a, const Image& b, const tool::ImageSize& part) {
  constexpr int grid = 16;
  const SumTable table(a, b);
  Corner best;
  for (int y = 0; y + part.height <= a.height; y += grid)
    for (int x = 0; x + part.width <= a.width; x += grid)
      if (table.of({x, y}, part) > table.of(best, part)) best = {x, y};
  return best;
}

Image cut_out(const Image& image, const Corner& corner, const tool::ImageSize& part) {
  Image result{part.width, part.height, {}};
  for (int y = 0; y < part.height; ++y) {
    const auto row = image.pixels.begin() + static_cast<std::ptrdiff_t>(at(image, corner.x, corner.y + y));
    result.pixels.insert(result.pixels.end(), row, row + part.width);
  }
  return result;
}

}  // namespace

SidePictures draw_beside(const SceneRun& run, const std::string& path, const std::vector<Setting>& settings,
                         const SweepOptions& options, const tool::ImageSize& part) {
  const auto [cameras, frame] = burst_of(run, path, options.bursts / 2, options);
  const View view(cameras.back());
  SidePictures pictures{frame, tool::FullMeshPicture(run.objects, view).image(), {}};
  for (const Setting& setting : settings) {
    SettingRun setting_run(setting, run.objects);
    setting_run.start(View(cameras.front()));
    for (std::size_t k = 1; k < cameras.size(); ++k) setting_run.next(View(cameras[k]));
    const tool::Measurement& drawn = setting_run.measurement();
    pictures.refined.push_back(tool::shade_without_wire(drawn.items(), drawn.objects(), view));
  }
  const tool::ImageSize size{std::min(part.width, view.width()), std::min(part.height, view.height())};
  const Corner corner = most_different(pictures.refined.front(), pictures.full, size);
  pictures.full = cut_out(pictures.full, corner, size);
  for (Image& image : pictures.refined) image = cut_out(image, corner, size);
  return pictures;
}

}  // namespace occlod::bench
