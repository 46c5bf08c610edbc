#include <utility>

#include "occlod/base.h"

namespace occlod {
namespace {

std::string one_line(const Diagnosis& diagnosis) {
  std::string line = diagnosis.subject;
  if (!diagnosis.place.empty()) line += ": " + diagnosis.place;
  line += ": " + diagnosis.problem;
  if (!diagnosis.remedy.empty()) line += "; " + diagnosis.remedy;
  return line;
}

}  // namespace

Error::Error(Diagnosis diagnosis) : std::runtime_error(one_line(diagnosis)), diagnosis_(std::move(diagnosis)) {}

const char* version() noexcept { return OCCLOD_VERSION; }

}  // namespace occlod
