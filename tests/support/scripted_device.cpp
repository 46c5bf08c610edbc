#include "support/scripted_device.h"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace occlod::test {

using hlod::BoxRef;
using hlod::Hlod;
using hlod::NodeId;
using hlod::QueryId;

NodeId node_with_box(const Hlod& hlod, const Box& box) {
  for (NodeId n = 0; n < hlod.node_count(); ++n)
    if (hlod.node(n).box.min == box.min && hlod.node(n).box.max == box.max) return n;
  throw std::runtime_error("a box of no node was asked about");
}

void ScriptedDevice::begin_frame(const View& view, std::span<const hlod::PlacedHlod> objects) {
  pixels_ = static_cast<std::uint32_t>(view.width() * view.height());
  objects_.assign(objects.begin(), objects.end());
  questions_.clear();
  commands_ = 0;
}

std::uint32_t ScriptedDevice::count(const BoxRef& box) const {
  const auto answers = answers_.find({box.object, node_with_box(*objects_[box.object].hlod, box.box)});
  if (answers == answers_.end()) return pixels_;
  const auto later = answers->second.upper_bound(frames_);
  return later == answers->second.begin() ? pixels_ : std::prev(later)->second;
}

QueryId ScriptedDevice::ask(std::span<const BoxRef> boxes) {
  std::uint32_t sum = 0;
  for (const BoxRef& box : boxes) sum = std::min(pixels_, sum + count(box));
  questions_.push_back({{sum}, ++commands_});
  return static_cast<QueryId>(questions_.size() - 1);
}

QueryId ScriptedDevice::ask_each(std::span<const BoxRef> boxes) {
  Question question{{}, ++commands_};
  for (const BoxRef& box : boxes) question.counts.push_back(count(box));
  questions_.push_back(std::move(question));
  return static_cast<QueryId>(questions_.size() - 1);
}

bool ScriptedDevice::available(QueryId query) { return commands_ - questions_[query].asked_at >= delay_; }

std::span<const std::uint32_t> ScriptedDevice::wait(QueryId query) { return questions_[query].counts; }

hlod::FrameTimes ScriptedDevice::end_frame() {
  ++frames_;
  return {};
}

void LoggedDevice::add(const std::string& entry) { log_ += (log_.empty() ? "" : ", ") + entry; }

std::string commands_of(const std::string& log) {
  std::istringstream entries(log);
  std::string result, entry;
  while (std::getline(entries >> std::ws, entry, ','))
    if (entry.rfind("ask", 0) == 0 || entry.rfind("draw", 0) == 0) result += (result.empty() ? "" : ", ") + entry;
  return result;
}

void LoggedDevice::begin_frame(const View& view, std::span<const hlod::PlacedHlod> objects) {
  log_.clear();
  asked_.clear();
  objects_.assign(objects.begin(), objects.end());
  device_.begin_frame(view, objects);
}

namespace {

std::string named(std::uint32_t object, NodeId node) {
  return (object > 0 ? std::to_string(object) + "/" : "") + std::to_string(node);
}

// Which patches the ranges are: " for 1+2", or nothing for all.
std::string patches_in(const Hlod& hlod, const hlod::NodeDraw& draw) {
  std::string parents;
  bool all = true;
  for (const hlod::Patch& patch : hlod.patches(draw.node)) {
    const bool drawn = std::any_of(draw.ranges.begin(), draw.ranges.end(), [&](const hlod::DrawRange& range) {
      return range.first_index <= patch.first_index &&
             patch.first_index + patch.index_count <= range.first_index + range.index_count;
    });
    all = all && drawn;
    if (drawn) parents += (parents.empty() ? " for " : "+") + std::to_string(patch.parent);
  }
  return all ? "" : parents;
}

}  // namespace

void LoggedDevice::draw(const hlod::NodeDraw& draw) {
  const Hlod& hlod = *objects_[draw.object].hlod;
  add("draw " + test::named(draw.object, draw.node) + patches_in(hlod, draw));
  device_.draw(draw);
}

std::string LoggedDevice::named(std::span<const BoxRef> boxes) const {
  std::string result;
  for (const BoxRef& box : boxes)
    result += (result.empty() ? "" : "+") + test::named(box.object, node_with_box(*objects_[box.object].hlod, box.box));
  return result;
}

QueryId LoggedDevice::ask(std::span<const BoxRef> boxes) {
  const std::string names = named(boxes);
  add("ask " + names);
  const QueryId query = device_.ask(boxes);
  asked_[query] = names;
  return query;
}

QueryId LoggedDevice::ask_each(std::span<const BoxRef> boxes) {
  const std::string names = named(boxes);
  add("ask each " + names);
  const QueryId query = device_.ask_each(boxes);
  asked_[query] = names;
  return query;
}

std::span<const std::uint32_t> LoggedDevice::wait(QueryId query) {
  add((device_.available(query) ? "get " : "wait ") + asked_.at(query));
  return device_.wait(query);
}

}  // namespace occlod::test
