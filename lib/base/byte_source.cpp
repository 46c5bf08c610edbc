#include "base/byte_source.h"

#include <utility>

#include "base/platform.h"

namespace occlod {
namespace {

class FileBytes final : public ByteSource {
 public:
  explicit FileBytes(std::shared_ptr<const InputFile> file) : file_(std::move(file)) {}

  [[nodiscard]] std::uint64_t size() const noexcept override { return file_->size(); }
  void read(std::span<const std::span<std::byte>> parts, std::uint64_t offset) const override {
    file_->read(parts, offset);
  }

 private:
  std::shared_ptr<const InputFile> file_;
};

}  // namespace

std::shared_ptr<const ByteSource> byte_source_of(std::shared_ptr<const InputFile> file) {
  return std::make_shared<FileBytes>(std::move(file));
}

}  // namespace occlod
