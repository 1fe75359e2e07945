// Takes more stack than there is.
#include <cstddef>

namespace {

volatile std::size_t deepest = 100'000;

[[gnu::noinline]] int deep(std::size_t left) {
  volatile int room[64];
  room[left % 64] = 1;
  const int below = left == 0 ? 0 : deep(left - 1);
  return below + room[left % 64];
}

}  // namespace

int main() {
  return deep(deepest);
}
