#include "cells/geometry_cache.h"

#include <algorithm>

namespace occlod::vlod {
namespace {

constexpr std::uint64_t most_at_once = 1U << 20U;  // bytes in the file, about

}  // namespace

void GeometryCache::get(std::span<const std::uint32_t> frames, Frames& out, std::uint64_t& bytes_read) {
  find(frames, out);
  for (std::size_t first = 0, end = 0; first < frames.size(); first = end) {
    end = first + 1;
    if (out[first]) continue;
    std::uint64_t bytes = geometry_.frames()[frames[first]].bytes;
    while (end < frames.size() && !out[end] && frames[end] == frames[end - 1] + 1 && bytes < most_at_once)
      bytes += geometry_.frames()[frames[end++]].bytes;
    read(frames[first], std::span(out).subspan(first, end - first), bytes_read);
  }
}

void GeometryCache::find(std::span<const std::uint32_t> frames, Frames& out) {
  out.assign(frames.size(), nullptr);
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (const auto found = entries_.find(frames[i]); found != entries_.end()) {
      found->second.asked = ++calls_;
      out[i] = found->second.frame;
    }
}

void GeometryCache::read(std::uint32_t first, std::span<std::shared_ptr<const GeometryFrame>> out,
                         std::uint64_t& bytes_read) {
  const auto count = static_cast<std::uint32_t>(out.size());
  std::uint64_t bytes = 0;
  for (const FrameRow& row : geometry_.frames().subspan(first, count)) bytes += row.bytes;
  if (before_read_) before_read_(bytes);
  std::ranges::move(geometry_.read(first, count), out.begin());
  bytes_read += bytes;
  const std::lock_guard lock(mutex_);
  for (std::uint32_t i = 0; i < count; ++i)
    if (out[i]->bytes() <= limit_ && entries_.try_emplace(first + i, Entry{out[i], ++calls_}).second)
      bytes_ += out[i]->bytes();
  shrink();
}

void GeometryCache::limit(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  limit_ = bytes;
  shrink();
}

std::size_t GeometryCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

void GeometryCache::shrink() {
  while (bytes_ > limit_) {
    const auto oldest = std::ranges::min_element(entries_, {}, [](const auto& entry) { return entry.second.asked; });
    bytes_ -= oldest->second.frame->bytes();
    entries_.erase(oldest);
  }
}

}  // namespace occlod::vlod
