// A firmware that asks for the heap. Nothing on a board gives memory, so it must not link.
#include <cstdlib>

int main() {
  void* volatile memory = std::malloc(16);
  return memory == nullptr;
}
