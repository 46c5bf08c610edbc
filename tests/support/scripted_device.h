// Devices for tests of traversal: one whose answers are scripted, and one that writes down what another is told.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "occlod/device.h"

namespace occlod::test {

// The node of an HLOD that has this box. Each has another, or the first one is taken.
[[nodiscard]] hlod::NodeId node_with_box(const hlod::Hlod& hlod, const Box& box);

// Draws nothing and answers what it has been told, at once or late. What it has not been told about is wholly visible.
class ScriptedDevice : public hlod::RenderDevice {
 public:
  // From this frame on, counted from 0, this node has so many visible pixels.
  void answer(std::size_t frame, hlod::NodeId node, std::uint32_t pixels, std::uint32_t object = 0) {
    answers_[{object, node}][frame] = pixels;
  }
  // Answers are there when so many draws and questions have followed the question, or when somebody waits.
  void delay(std::size_t commands) { delay_ = commands; }

  [[nodiscard]] std::string_view name() const noexcept override { return "scripted"; }
  void begin_frame(const View& view, std::span<const hlod::PlacedHlod> objects) override;
  void draw(const hlod::NodeDraw&) override { ++commands_; }
  [[nodiscard]] hlod::QueryId ask(std::span<const hlod::BoxRef> boxes) override;
  [[nodiscard]] hlod::QueryId ask_each(std::span<const hlod::BoxRef> boxes) override;
  [[nodiscard]] bool available(hlod::QueryId query) override;
  [[nodiscard]] std::span<const std::uint32_t> wait(hlod::QueryId query) override;
  void visit(std::size_t) override {}
  hlod::FrameTimes end_frame() override;

 private:
  struct Question {
    std::vector<std::uint32_t> counts;
    std::size_t asked_at = 0;  // commands before it
  };
  [[nodiscard]] std::uint32_t count(const hlod::BoxRef& box) const;

  std::map<std::pair<std::uint32_t, hlod::NodeId>, std::map<std::size_t, std::uint32_t>> answers_;
  std::size_t delay_ = 0;
  std::size_t frames_ = 0;
  std::size_t commands_ = 0;  // of this frame
  std::uint32_t pixels_ = 0;  // of the image
  std::vector<hlod::PlacedHlod> objects_;
  std::vector<Question> questions_;  // of this frame
};

// Says that every answer is there, and waits for those that are not: another device without its delays.
class PromptDevice : public hlod::RenderDevice {
 public:
  explicit PromptDevice(hlod::RenderDevice& device) : device_(device) {}
  [[nodiscard]] std::string_view name() const noexcept override { return device_.name(); }
  void begin_frame(const View& view, std::span<const hlod::PlacedHlod> objects) override {
    device_.begin_frame(view, objects);
  }
  void draw(const hlod::NodeDraw& draw) override { device_.draw(draw); }
  [[nodiscard]] hlod::QueryId ask(std::span<const hlod::BoxRef> boxes) override { return device_.ask(boxes); }
  [[nodiscard]] hlod::QueryId ask_each(std::span<const hlod::BoxRef> boxes) override { return device_.ask_each(boxes); }
  [[nodiscard]] bool available(hlod::QueryId) override { return true; }
  [[nodiscard]] std::span<const std::uint32_t> wait(hlod::QueryId query) override { return device_.wait(query); }
  void visit(std::size_t nodes) override { device_.visit(nodes); }
  hlod::FrameTimes end_frame() override { return device_.end_frame(); }

 private:
  hlod::RenderDevice& device_;
};

// Of a log, the draws and questions only.
[[nodiscard]] std::string commands_of(const std::string& log);

// Passes everything on to another device and writes it down: "ask 1, draw 1, get 1" for a node that is asked about,
// drawn, and answered without waiting, "wait 1" where the answer was not there yet. "draw 4 for 2": only the patch that
// node 2 replaces. Nodes of objects other than the first: "ask 1/0". Boxes in one question: "ask 1+2".
class LoggedDevice : public hlod::RenderDevice {
 public:
  explicit LoggedDevice(hlod::RenderDevice& device) : device_(device) {}
  // Of the last frame.
  [[nodiscard]] const std::string& log() const noexcept { return log_; }

  [[nodiscard]] std::string_view name() const noexcept override { return device_.name(); }
  void begin_frame(const View& view, std::span<const hlod::PlacedHlod> objects) override;
  void draw(const hlod::NodeDraw& draw) override;
  [[nodiscard]] hlod::QueryId ask(std::span<const hlod::BoxRef> boxes) override;
  [[nodiscard]] hlod::QueryId ask_each(std::span<const hlod::BoxRef> boxes) override;
  [[nodiscard]] bool available(hlod::QueryId query) override { return device_.available(query); }
  [[nodiscard]] std::span<const std::uint32_t> wait(hlod::QueryId query) override;
  void visit(std::size_t nodes) override { device_.visit(nodes); }
  hlod::FrameTimes end_frame() override { return device_.end_frame(); }

 private:
  void add(const std::string& entry);
  [[nodiscard]] std::string named(std::span<const hlod::BoxRef> boxes) const;

  hlod::RenderDevice& device_;
  std::string log_;
  std::vector<hlod::PlacedHlod> objects_;
  std::map<hlod::QueryId, std::string> asked_;  // what each question is about
};

}  // namespace occlod::test
