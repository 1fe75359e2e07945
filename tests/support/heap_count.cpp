#include "support/heap_count.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<long> count{0};

// operator new is counted through the malloc that it calls.
void* take(std::size_t size) noexcept {
  return std::malloc(size > 0 ? size : 1);
}

void* take(std::size_t size, std::align_val_t alignment) noexcept {
  const auto a = static_cast<std::size_t>(alignment);
  return std::aligned_alloc(a, (size + a - 1) / a * a);
}

void* or_throw(void* p) {
  if (p == nullptr) throw std::bad_alloc();
  return p;
}

}  // namespace

// What C code and Eigen call directly. The linker redirects calls to these functions (--wrap), except those from shared
// libraries.
extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t count, std::size_t size);
void* __real_realloc(void* p, std::size_t size);
void* __real_aligned_alloc(std::size_t alignment, std::size_t size);
int __real_posix_memalign(void** p, std::size_t alignment, std::size_t size);

void* __wrap_malloc(std::size_t size) {
  count.fetch_add(1, std::memory_order_relaxed);
  return __real_malloc(size);
}
void* __wrap_calloc(std::size_t number, std::size_t size) {
  count.fetch_add(1, std::memory_order_relaxed);
  return __real_calloc(number, size);
}
void* __wrap_realloc(void* p, std::size_t size) {
  count.fetch_add(1, std::memory_order_relaxed);
  return __real_realloc(p, size);
}
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size) {
  count.fetch_add(1, std::memory_order_relaxed);
  return __real_aligned_alloc(alignment, size);
}
int __wrap_posix_memalign(void** p, std::size_t alignment, std::size_t size) {
  count.fetch_add(1, std::memory_order_relaxed);
  return __real_posix_memalign(p, alignment, size);
}
}

long curbline::test::heap_count() {
  return count.load(std::memory_order_relaxed);
}

// Every form is replaced, not only the one that the others call by default, because a sanitizer brings its own version
// of each.
void* operator new(std::size_t n) {
  return or_throw(take(n));
}
void* operator new[](std::size_t n) {
  return or_throw(take(n));
}
void* operator new(std::size_t n, std::align_val_t a) {
  return or_throw(take(n, a));
}
void* operator new[](std::size_t n, std::align_val_t a) {
  return or_throw(take(n, a));
}
void* operator new(std::size_t n, const std::nothrow_t&) noexcept {
  return take(n);
}
void* operator new[](std::size_t n, const std::nothrow_t&) noexcept {
  return take(n);
}
void* operator new(std::size_t n, std::align_val_t a, const std::nothrow_t&) noexcept {
  return take(n, a);
}
void* operator new[](std::size_t n, std::align_val_t a, const std::nothrow_t&) noexcept {
  return take(n, a);
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete[](void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}
