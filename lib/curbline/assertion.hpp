// What happens at a bug: of the library, or of a caller that breaks what a header demands. Bad data and bad settings
// are none: they are counted, or refused with a Status.
#pragma once

namespace curbline {

/// Called with what should have held; must not return. The library's own, a trap, is weak: a board that stops its
/// motors first, or writes down what it was, defines this function itself. May be called from anywhere.
[[noreturn]] void assertion_failed(const char* what);

inline void expects(bool holds, const char* what) {
  if (!holds) [[unlikely]]
    assertion_failed(what);
}

}  // namespace curbline
