#include "curbline/assertion.hpp"

namespace curbline {

[[gnu::weak, gnu::cold]] void assertion_failed(const char*) {
  __builtin_trap();
}

}  // namespace curbline
