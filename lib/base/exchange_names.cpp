#include "base/exchange_names.h"

#include <fcntl.h>

#include <cstdio>

namespace occlod {

bool exchange_names([[maybe_unused]] const char* a, [[maybe_unused]] const char* b) noexcept {
#ifdef RENAME_EXCHANGE  // Linux
  return renameat2(AT_FDCWD, a, AT_FDCWD, b, RENAME_EXCHANGE) == 0;
#else
  return false;
#endif
}

}  // namespace occlod
