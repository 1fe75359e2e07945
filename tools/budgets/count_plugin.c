// A QEMU plugin that counts the instructions of a firmware by stage and by scan line. Arguments: map=FILE (what tools/budget made
// of the firmware's debug information: `line ADDRESS`, then `range FIRST END STAGE`, hexadecimal, stage -1 for helpers) and out=FILE
// (a row of counts by stage for each line). An instruction of a helper, such as memcpy, counts for the stage that ran last. A line
// ends where the instruction at `line` is reached. Counts repeat exactly. Single core, no interrupts.
// Source: QEMU, TCG Plugins, version 1 of the interface; its header is in no package, so what is used of it stands here.
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
extern void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t, void (*)(qemu_plugin_id_t, struct qemu_plugin_tb*));
extern void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb*, void (*)(unsigned, void*), int flags, void*);
extern void qemu_plugin_register_atexit_cb(qemu_plugin_id_t, void (*)(qemu_plugin_id_t, void*), void*);
extern size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb*);
extern struct qemu_plugin_insn* qemu_plugin_tb_get_insn(const struct qemu_plugin_tb*, size_t);
extern uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn*);
__attribute__((visibility("default"))) int qemu_plugin_version = 1;

enum { stages = 16, most_ranges = 1 << 16, no_registers = 0 };

struct Range {
  uint64_t first, end;
  int stage;
};
/// What a block of translated code adds.
struct Block {
  int ends_line;
  uint32_t leading_helpers;  ///< before the first instruction that has a stage
  uint32_t count[stages];
  int last_stage;            ///< -1: none of its instructions has one
};

static struct Range ranges[most_ranges];
static size_t range_count;
static uint64_t line_address;
static uint64_t counts[stages];
static int current;
static FILE* out;

static int stage_of(uint64_t address) {
  size_t low = 0, high = range_count;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (ranges[middle].end <= address) low = middle + 1;
    else high = middle;
  }
  return low < range_count && ranges[low].first <= address ? ranges[low].stage : -1;
}

static void end_line(void) {
  for (int s = 0; s < stages; ++s) fprintf(out, "%" PRIu64 "%c", counts[s], s + 1 < stages ? ',' : '\n');
  memset(counts, 0, sizeof counts);
}

static void on_block(unsigned cpu, void* data) {
  (void)cpu;
  const struct Block* block = data;
  if (block->ends_line) end_line();
  counts[current] += block->leading_helpers;
  if (block->last_stage < 0) return;
  for (int s = 0; s < stages; ++s) counts[s] += block->count[s];
  current = block->last_stage;
}

static void on_translation(qemu_plugin_id_t id, struct qemu_plugin_tb* tb) {
  (void)id;
  struct Block* block = calloc(1, sizeof *block);  // lives as long as the translation may: to the end
  if (block == NULL) abort();
  block->last_stage = -1;
  const size_t n = qemu_plugin_tb_n_insns(tb);
  for (size_t i = 0; i < n; ++i) {
    const uint64_t address = qemu_plugin_insn_vaddr(qemu_plugin_tb_get_insn(tb, i));
    if (i == 0 && address == line_address) block->ends_line = 1;  // a function's entry begins a block
    const int stage = stage_of(address);
    if (stage >= 0) block->last_stage = stage;
    if (block->last_stage < 0) ++block->leading_helpers;
    else ++block->count[block->last_stage];
  }
  qemu_plugin_register_vcpu_tb_exec_cb(tb, on_block, no_registers, block);
}

static void at_end(qemu_plugin_id_t id, void* data) {
  (void)id;
  (void)data;
  if (fclose(out) != 0) abort();
}

static int read_map(const char* path) {
  FILE* file = fopen(path, "r");
  if (file == NULL) return -1;
  int good = fscanf(file, " line %" SCNx64, &line_address) == 1;
  struct Range range;
  while (good && fscanf(file, " range %" SCNx64 " %" SCNx64 " %d", &range.first, &range.end, &range.stage) == 3) {
    good = range_count < most_ranges && range.stage < stages;
    if (good) ranges[range_count++] = range;
  }
  good = good && feof(file);
  fclose(file);
  return good ? 0 : -1;
}

__attribute__((visibility("default"))) int qemu_plugin_install(qemu_plugin_id_t id, const void* info, int count, char** words) {
  (void)info;
  for (int i = 0; i < count; ++i) {
    if (strncmp(words[i], "map=", 4) == 0 && read_map(words[i] + 4) != 0) {
      fprintf(stderr, "%s: not a map of stages\n", words[i] + 4);
      return -1;
    }
    if (strncmp(words[i], "out=", 4) == 0) out = fopen(words[i] + 4, "w");
  }
  if (out == NULL || line_address == 0) {
    fprintf(stderr, "count_plugin: expected map=FILE,out=FILE\n");
    return -1;
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, on_translation);
  qemu_plugin_register_atexit_cb(id, at_end, NULL);
  return 0;
}
