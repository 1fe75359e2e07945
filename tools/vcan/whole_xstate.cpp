// Preloaded into User-Mode Linux. Debian 12's kernel of it keeps 2,696 bytes of a process's floating-point and vector
// registers, which is all of them up to AVX-512; the host's kernel takes them back only as a whole (Linux,
// arch/x86/kernel/fpu/regset.c, xstateregs_set), and where the processor has more, such as AMX, the guest's first
// process would end. What the guest does not know of is put back as it was.
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

// Looked up before the guest starts, and no buffer on the stack: the guest's stacks are small.
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
