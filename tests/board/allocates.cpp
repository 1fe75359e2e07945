// A firmware that uses the heap. Nothing on a board provides one, so it must not link.
#include <cstdlib>

int main() {
  void* volatile memory = std::malloc(16);
  return memory == nullptr;
}
