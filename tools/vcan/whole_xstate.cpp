// Preloaded into User-Mode Linux. Debian 12's User-Mode Linux keeps 2,696 bytes of a process's floating-point and
// vector registers, which is everything up to AVX-512. The host's kernel only accepts the complete state (Linux,
// arch/x86/kernel/fpu/regset.c, xstateregs_set), so on processors with more state, such as AMX, the guest's first
// process would end. The state that the guest does not know is restored unchanged.
#include <dlfcn.h>
#include <elf.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

#include <cstdarg>
#include <cstdint>
#include <cstring>

namespace {

using Ptrace = long (*)(__ptrace_request, pid_t, void*, void*);

// Looked up before the guest starts, and no buffer on the stack, because the guest's stacks are small.
const auto next_ptrace = reinterpret_cast<Ptrace>(::dlsym(RTLD_NEXT, "ptrace"));
alignas(64) char registers[1 << 16];

}  // namespace

extern "C" long ptrace(__ptrace_request request, ...) noexcept {
  std::va_list rest;
  va_start(rest, request);
  const auto process = va_arg(rest, pid_t);
  const auto address = va_arg(rest, void*);
  const auto data = va_arg(rest, void*);
  va_end(rest);
  if (request == PTRACE_SETREGSET && reinterpret_cast<std::uintptr_t>(address) == NT_X86_XSTATE) {
    const auto known = static_cast<const iovec*>(data);
    iovec whole{registers, sizeof registers};
    if (next_ptrace(PTRACE_GETREGSET, process, address, &whole) == 0 && whole.iov_len > known->iov_len) {
      std::memcpy(registers, known->iov_base, known->iov_len);
      return next_ptrace(request, process, address, &whole);
    }
  }
  return next_ptrace(request, process, address, data);
}
