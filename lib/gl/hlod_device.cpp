#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gl/backend_options.h"
#include "gl/context.h"
#include "gl/hlod_stage.h"
#include "gl/objects.h"
#include "occlod/base.h"
#include "occlod/gl.h"

namespace occlod::gl {
namespace {

// When the device worked during a frame, by timer queries.

// Between start() and stop() commands are given; between stop() and start() the device may run out of them. Its context
// is current in every call.
class FrameTimer {
 public:
  // renderer: GL_RENDERER. Of drivers that draw on the CPU, what timers say of single commands is the time of the last
  // tile, so they are not asked.
  FrameTimer(const Functions& gl, std::string_view renderer);

  [[nodiscard]] bool is_meaningful() const noexcept { return meaningful_; }
  void begin_frame();
  void start();  // nothing when started already
  void stop();   // nothing when stopped already

  struct Times {
    double busy_ms = 0.0;  // from each start to the next stop
    double idle_ms = 0.0;  // from each stop to the next start
  };
  // Of the frame, when all commands are done; zeros where timers are not meaningful.
  [[nodiscard]] Times read() const;

 private:
  void stamp();
  [[nodiscard]] double milliseconds(std::size_t stamp) const;

  const Functions* gl_;
  bool meaningful_;
  bool started_ = false;
  std::vector<Query> stamps_;
  std::size_t used_ = 0;  // of stamps_: starts and stops by turns
};

bool has_timer(const Functions& gl) {
  GLint bits = 0;
  gl.GetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
  return bits > 0;
}

FrameTimer::FrameTimer(const Functions& gl, std::string_view renderer)
    : gl_(&gl), meaningful_(!draws_on_cpu(renderer) && has_timer(gl)) {}

void FrameTimer::begin_frame() {
  started_ = false;
  used_ = 0;
}

void FrameTimer::start() {
  if (!std::exchange(started_, true)) stamp();
}

void FrameTimer::stop() {
  if (std::exchange(started_, false)) stamp();
}

void FrameTimer::stamp() {
  if (!meaningful_) return;
  if (used_ == stamps_.size()) stamps_.emplace_back(*gl_);
  gl_->QueryCounter(stamps_[used_++].id(), GL_TIMESTAMP);
}

double FrameTimer::milliseconds(std::size_t stamp) const {
  GLuint64 nanoseconds = 0;
  gl_->GetQueryObjectui64v(stamps_[stamp].id(), GL_QUERY_RESULT, &nanoseconds);
  return static_cast<double>(nanoseconds) / 1e6;
}

FrameTimer::Times FrameTimer::read() const {
  assert(!started_);
  Times times;
  for (std::size_t i = 0; i + 1 < used_; ++i) {
    const double between = milliseconds(i + 1) - milliseconds(i);
    (i % 2 == 0 ? times.busy_ms : times.idle_ms) += between;
  }
  return times;
}

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration duration) { return std::chrono::duration<double, std::milli>(duration).count(); }

// Pixels of one box or several that OpenGL counts.
struct Count {
  std::optional<Query> query;  // until the answer is taken; none when it was known at once, or is counted by marks
  std::uint32_t most = 0;      // pixels that it can be
};

// Where the boxes of a batch count.
struct Marks {
  Buffer words;  // one for each count of the batch
  Fence written;
};

// A call of ask() or ask_each().
struct Batch {
  std::size_t first = 0;  // into the counts of the frame
  std::size_t count = 0;
  std::optional<Marks> marks = {};  // until the answers are taken; none when there are queries or nothing is drawn
};

// A driver on the processor draws so many nodes at a time: what it gathers for more no longer fits into caches. Frames
// of 540 nodes without a query take 0.65 to 0.8 times as long as in one go (llvmpipe on one thread).
constexpr std::size_t draws_at_a_time = 8;

// Everything that lives in the context, and what is under way there.
struct Resources {
  Resources(const Functions& gl, const HlodDeviceOptions& options, const HlodDeviceCalls& calls,
            std::string_view renderer)
      : stage(gl, options, calls), pool(GL_SAMPLES_PASSED), timer(gl, renderer), on_cpu(draws_on_cpu(renderer)) {}

  HlodStage stage;
  QueryPool pool;
  FrameTimer timer;
  bool on_cpu;
  // Of the frame:
  std::size_t draws = 0;
  std::vector<Batch> batches;
  std::vector<Count> counts;
  std::vector<std::uint32_t> answers;  // as many as counts
  std::vector<BoxProxy> proxies;       // of one count
  std::vector<MarkedBox> marked;       // of one batch
  std::vector<std::uint32_t> words;    // likewise
  std::vector<Buffer> idle_words;
};

class GlHlodDevice final : public HlodDevice {
 public:
  GlHlodDevice(std::shared_ptr<Context> context, const HlodDeviceOptions& options, const HlodDeviceCalls& calls,
               const std::string& renderer)
      : resources_(std::move(context), options, calls, renderer) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "gl"; }
  void begin_frame(const View& view, std::span<const hlod::PlacedHlod> objects) override;
  void draw(const hlod::NodeDraw& draw) override;
  [[nodiscard]] hlod::QueryId ask(std::span<const hlod::BoxRef> boxes) override;
  [[nodiscard]] hlod::QueryId ask_each(std::span<const hlod::BoxRef> boxes) override;
  [[nodiscard]] bool available(hlod::QueryId query) override;
  [[nodiscard]] std::span<const std::uint32_t> wait(hlod::QueryId query) override;
  void visit(std::size_t /*nodes*/) override {}
  hlod::FrameTimes end_frame() override;

  [[nodiscard]] Image read_image() override { return resources_.use().stage.read_image(); }
  [[nodiscard]] DepthBuffer read_depth() override { return resources_.use().stage.read_depth(); }
  [[nodiscard]] MeshMemory mesh_memory() const noexcept override { return resources_.look().stage.mesh_memory(); }
  [[nodiscard]] CallCounts calls() const noexcept override { return resources_.look().stage.calls(); }
  [[nodiscard]] bool measures_gpu() const noexcept override { return resources_.look().timer.is_meaningful(); }

 private:
  InContext<Resources> resources_;
  Clock::time_point begin_;
  Clock::duration stall_{};
};

std::span<Count> counts_of(Resources& resources, const Batch& batch) {
  return std::span(resources.counts).subspan(batch.first, batch.count);
}

// Of boxes that are not drawn `most` is 0, and the answer is there already.
void take_marks(Resources& resources, Batch& batch) {
  Marks marks = *std::exchange(batch.marks, std::nullopt);
  const Functions& gl = resources.stage.gl();
  resources.words.resize(batch.count);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, marks.words.id());
  marks.written.wait("counting boxes");
  gl.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(batch.count * sizeof(std::uint32_t)),
                      resources.words.data());
  check(gl, "counting boxes");
  for (std::size_t i = 0; i < batch.count; ++i)
    if (const Count& count = resources.counts[batch.first + i]; count.most > 0)
      resources.answers[batch.first + i] = std::min(resources.words[i], count.most);
  resources.idle_words.push_back(std::move(marks.words));
}

void take_answers(Resources& resources, Batch& batch) {
  if (batch.marks) return take_marks(resources, batch);
  const std::uint32_t samples = resources.stage.samples_per_pixel();
  for (std::size_t i = batch.first; i < batch.first + batch.count; ++i) {
    Count& count = resources.counts[i];
    if (!count.query) continue;
    const std::uint32_t passed = resources.pool.take(resources.stage.gl(), *std::exchange(count.query, std::nullopt));
    // Drivers may count too many: llvmpipe has been seen to add 63,000.
    resources.answers[i] = std::min((passed + samples - 1) / samples, count.most);
  }
  // A lost context may answer anything.
  check(resources.stage.gl(), "occlusion query");
}

// Of the counts that were added since the last one.
hlod::QueryId add_batch(Resources& resources, std::size_t count) {
  resources.batches.push_back({resources.counts.size() - count, count, std::nullopt});
  return static_cast<hlod::QueryId>(resources.batches.size() - 1);
}

void forget_queries(Resources& resources) {
  for (Count& count : resources.counts)
    if (count.query) resources.pool.drop(*std::exchange(count.query, std::nullopt));
  for (Batch& batch : resources.batches)
    if (batch.marks) resources.idle_words.push_back(std::move(batch.marks->words));
  resources.batches.clear();
  resources.counts.clear();
  resources.answers.clear();
}

void GlHlodDevice::begin_frame(const View& view, std::span<const hlod::PlacedHlod> objects) {
  begin_ = Clock::now();
  stall_ = {};
  Resources& resources = resources_.use();
  forget_queries(resources);
  resources.draws = 0;
  resources.timer.begin_frame();
  resources.timer.start();
  resources.stage.begin_frame(view, objects);
}

void GlHlodDevice::draw(const hlod::NodeDraw& draw) {
  Resources& resources = resources_.use();
  resources.timer.start();
  resources.stage.draw(draw);
  if (!resources.on_cpu || ++resources.draws % draws_at_a_time != 0) return;
  resources.stage.submit();
  resources.stage.gl().Flush();
}

// Asks for one count of all boxes.
void add_count(Resources& resources, std::span<const hlod::BoxRef> boxes) {
  HlodStage& stage = resources.stage;
  const std::uint32_t all = stage.pixels();
  std::uint64_t most = 0;
  bool any_is_uncertain = false;
  resources.proxies.clear();
  for (const hlod::BoxRef& box : boxes) {
    const BoxProxy proxy = stage.project(box);
    any_is_uncertain = any_is_uncertain || proxy.kind == BoxProxy::Kind::uncertain;
    if (proxy.kind != BoxProxy::Kind::drawn) continue;
    most += stage.max_pixels(proxy);
    resources.proxies.push_back(proxy);
  }
  if (any_is_uncertain || resources.proxies.empty()) {
    resources.counts.push_back({std::nullopt, 0});
    resources.answers.push_back(any_is_uncertain ? all : 0);
    return;
  }
  resources.timer.start();
  stage.start_proxies();
  Query query = resources.pool.begin(stage.gl());
  for (const BoxProxy& proxy : resources.proxies) stage.draw_proxy(proxy);
  resources.pool.end(stage.gl());
  resources.counts.push_back({std::move(query), static_cast<std::uint32_t>(std::min<std::uint64_t>(most, all))});
  resources.answers.push_back(0);
}

// Asks for a count of each box.
hlod::QueryId add_marks(Resources& resources, std::span<const hlod::BoxRef> boxes) {
  HlodStage& stage = resources.stage;
  std::vector<MarkedBox>& marked = resources.marked;
  marked.clear();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const BoxProxy proxy = stage.project(boxes[i]);
    const bool is_drawn = proxy.kind == BoxProxy::Kind::drawn;
    if (is_drawn) marked.push_back({HlodStage::unit_to_clip(proxy), static_cast<std::uint32_t>(i)});
    resources.counts.push_back({std::nullopt, is_drawn ? stage.max_pixels(proxy) : 0});
    resources.answers.push_back(proxy.kind == BoxProxy::Kind::uncertain ? stage.pixels() : 0);
  }
  const hlod::QueryId query = add_batch(resources, boxes.size());
  if (marked.empty()) return query;
  resources.timer.start();
  const Functions& gl = stage.gl();
  if (resources.idle_words.empty()) resources.idle_words.emplace_back(gl);
  Buffer words = std::move(resources.idle_words.back());
  resources.idle_words.pop_back();
  resources.words.assign(boxes.size(), 0);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, words.id());
  fill(gl, GL_SHADER_STORAGE_BUFFER, std::span<const std::uint32_t>(resources.words), GL_DYNAMIC_READ);
  stage.mark_boxes(marked, words);
  gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  resources.batches.back().marks.emplace(Marks{std::move(words), Fence(gl)});
  return query;
}

hlod::QueryId GlHlodDevice::ask(std::span<const hlod::BoxRef> boxes) {
  assert(!boxes.empty());
  Resources& resources = resources_.use();
  add_count(resources, boxes);
  return add_batch(resources, 1);
}

hlod::QueryId GlHlodDevice::ask_each(std::span<const hlod::BoxRef> boxes) {
  Resources& resources = resources_.use();
  if (resources.stage.can_mark()) return add_marks(resources, boxes);
  for (std::size_t i = 0; i < boxes.size(); ++i) add_count(resources, boxes.subspan(i, 1));
  return add_batch(resources, boxes.size());
}

bool GlHlodDevice::available(hlod::QueryId query) {
  Resources& resources = resources_.use();
  assert(query < resources.batches.size());
  if (const auto& marks = resources.batches[query].marks) return marks->written.is_over();
  // OpenGL answers queries of one kind in the order in which they were issued.
  const std::span<const Count> counts = counts_of(resources, resources.batches[query]);
  const auto last =
      std::find_if(counts.rbegin(), counts.rend(), [](const Count& count) { return count.query.has_value(); });
  return last == counts.rend() || QueryPool::is_available(resources.stage.gl(), *last->query);
}

std::span<const std::uint32_t> GlHlodDevice::wait(hlod::QueryId query) {
  const Clock::time_point start = Clock::now();
  Resources& resources = resources_.use();
  assert(query < resources.batches.size());
  Batch& batch = resources.batches[query];
  if (!available(query)) {
    resources.stage.submit();
    resources.timer.stop();
  }
  take_answers(resources, batch);
  stall_ += Clock::now() - start;
  return std::span(resources.answers).subspan(batch.first, batch.count);
}

hlod::FrameTimes GlHlodDevice::end_frame() {
  Resources& resources = resources_.use();
  resources.stage.submit();
  resources.timer.stop();
  const Clock::time_point given = Clock::now();
  Fence(resources.stage.gl()).wait("end of a frame");
  const Clock::time_point end = Clock::now();
  const FrameTimer::Times gpu = resources.timer.read();
  return {milliseconds(end - begin_), milliseconds(given - begin_), gpu.busy_ms, milliseconds(stall_), gpu.idle_ms};
}

}  // namespace

std::unique_ptr<HlodDevice> make_hlod_device(std::shared_ptr<Context> context, const HlodDeviceOptions& options,
                                             const HlodDeviceCalls& calls) {
  if (context == nullptr) throw Error({"gl device", "", "has no OpenGL context", "make one with create_context()"});
  if (options.mesh_bytes == 0) throw Error({"gl device", "mesh_bytes", "is 0", "use some megabytes"});
  context->make_current();
  const std::string renderer = context->renderer();
  return std::make_unique<GlHlodDevice>(std::move(context), options, calls, renderer);
}

std::unique_ptr<HlodDevice> make_hlod_device(std::shared_ptr<Context> context, const HlodDeviceOptions& options) {
  return make_hlod_device(std::move(context), options, HlodDeviceCalls{});
}

}  // namespace occlod::gl
