// The text of what is thrown, for tests that compare it.
#pragma once

#include <functional>
#include <string>

#include "occlod/base.h"

namespace occlod::test {

// Returns the text of the Error that the call throws, or nothing when it throws none.
inline std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace occlod::test
