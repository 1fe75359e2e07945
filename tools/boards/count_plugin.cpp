// A QEMU plugin that counts the instructions of a firmware by stage and by scan line. Arguments: map=FILE (written by
// tools/budget from the firmware's debug information: `line ADDRESS`, then `range FIRST END STAGE`, hexadecimal, stage
// -1 for helpers) and out=FILE (a row of counts by stage for each line). An instruction of a helper, such as memcpy,
// counts for the stage that ran last. A line ends when the instruction at `line` is reached. Counts repeat exactly. For
// firmware on one core without interrupts; instructions outside all ranges belong to another core and are not counted.
// Source: QEMU, TCG Plugins, version 1 of the interface; no package contains its header, so the declarations needed are
// repeated here.
#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

extern "C" {
using qemu_plugin_id_t = std::uint64_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t, void (*)(qemu_plugin_id_t, qemu_plugin_tb*));
void qemu_plugin_register_vcpu_tb_exec_cb(qemu_plugin_tb*, void (*)(unsigned, void*), int flags, void*);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t, void (*)(qemu_plugin_id_t, void*), void*);
std::size_t qemu_plugin_tb_n_insns(const qemu_plugin_tb*);
qemu_plugin_insn* qemu_plugin_tb_get_insn(const qemu_plugin_tb*, std::size_t);
std::uint64_t qemu_plugin_insn_vaddr(const qemu_plugin_insn*);
[[gnu::visibility("default")]] int qemu_plugin_version = 1;
[[gnu::visibility("default")]] int qemu_plugin_install(qemu_plugin_id_t id, const void* info, int count, char** words);
}

namespace {

constexpr int stages = 16, helper = -1, elsewhere = -2;
constexpr int no_registers = 0;
using Counts = std::array<std::uint64_t, stages>;

struct Range {
  std::uint64_t first, end;
  int stage;
};
/// The counts that a block of translated code adds.
struct Block {
  bool ends_line = false;
  std::uint64_t leading_helpers = 0;  ///< before the first instruction that has a stage
  Counts counts{};
  int last_stage = helper;  ///< `helper` if none of its instructions has a stage
};

std::vector<Range> ranges;  ///< ascending
std::uint64_t line_address = 0;
Counts counts{};
std::size_t current = 0;  ///< the stage that ran last
std::FILE* out = nullptr;

int stage_of(std::uint64_t address) {
  const auto range =
      std::partition_point(ranges.begin(), ranges.end(), [&](const Range& r) { return r.end <= address; });
  return range != ranges.end() && range->first <= address ? range->stage : elsewhere;
}

void end_line() {
  for (std::size_t s = 0; s < counts.size(); ++s) std::fprintf(out, "%s%" PRIu64, s > 0 ? "," : "", counts[s]);
  std::fputc('\n', out);
  counts.fill(0);
}

void on_block(unsigned, void* data) {
  const Block& block = *static_cast<const Block*>(data);
  if (block.ends_line) end_line();
  counts[current] += block.leading_helpers;
  if (block.last_stage == helper) return;
  for (std::size_t s = 0; s < counts.size(); ++s) counts[s] += block.counts[s];
  current = static_cast<std::size_t>(block.last_stage);
}

void on_translation(qemu_plugin_id_t, qemu_plugin_tb* tb) {
  auto* const block = new Block;  // lives until the end, as the translation may
  const std::size_t n = qemu_plugin_tb_n_insns(tb);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint64_t address = qemu_plugin_insn_vaddr(qemu_plugin_tb_get_insn(tb, i));
    if (i == 0 && address == line_address) block->ends_line = true;  // a function's entry begins a block
    const int stage = stage_of(address);
    if (stage == elsewhere) continue;  // code of another core
    if (stage != helper) block->last_stage = stage;
    ++(block->last_stage == helper ? block->leading_helpers
                                   : block->counts[static_cast<std::size_t>(block->last_stage)]);
  }
  qemu_plugin_register_vcpu_tb_exec_cb(tb, on_block, no_registers, block);
}

void at_end(qemu_plugin_id_t, void*) {
  if (std::fclose(out) != 0) std::perror("count_plugin");
}

bool read_map(const char* path) {
  std::FILE* const file = std::fopen(path, "r");
  if (file == nullptr) return false;
  bool good = std::fscanf(file, " line %" SCNx64, &line_address) == 1;
  Range range{};
  while (good && std::fscanf(file, " range %" SCNx64 " %" SCNx64 " %d", &range.first, &range.end, &range.stage) == 3) {
    good = range.stage >= helper && range.stage < stages;
    ranges.push_back(range);
  }
  good = good && std::feof(file) != 0;
  std::fclose(file);
  return good;
}

}  // namespace

int qemu_plugin_install(qemu_plugin_id_t id, const void*, int count, char** words) {
  bool good = true;
  for (int i = 0; i < count; ++i) {
    if (std::strncmp(words[i], "map=", 4) == 0) good = read_map(words[i] + 4);
    if (std::strncmp(words[i], "out=", 4) == 0) out = std::fopen(words[i] + 4, "w");
  }
  if (!good || out == nullptr || line_address == 0) {
    std::fprintf(stderr, "count_plugin: expected map=FILE,out=FILE with a map by tools/budget and a file to write\n");
    return -1;
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, on_translation);
  qemu_plugin_register_atexit_cb(id, at_end, nullptr);
  return 0;
}
