// Sizes fixed at compile time. One Limits value parametrises the pipeline, and sizeof(Pipeline<limits>) is all of its
// memory: nothing is allocated later. The stack of a call holds a bit for each cell (those that steps cross), a byte
// for each region (its rank) and 140 bytes for each plane, beyond 64 planes also 2 for each pair, or 4 from 65,535
// cells on: 255 need 130 KiB. settle(), for finished maps, holds a byte more for each cell. On a Cortex-M7, with
// regions in proportion to the cells, without settle():
//
//   cells a side        40      80     120     200     400
//   stack, bytes     2,912   3,656   6,384  15,736  60,048
//
// (tools/boards/stack.py, of the drive.elf of board/_template with these limits in its robot.hpp.)
#pragma once

namespace curbline {

/// Every size is a capacity. The window in use may be smaller (Settings::window); a full store refuses and counts
/// (Counters). Scale regions, links, borders and curbs with the number of cells.
struct Limits {
  int rows = 40;          ///< cells of the window along x, a multiple of 4 below 32768
  int cols = 40;          ///< cells of the window along y, likewise
  int planes = 16;        ///< planes of the mixture, 2 to 255
  int beams = 1081;       ///< beams of a scan line
  int tilt_samples = 64;  ///< tilt readings kept, a power of two from 4 on: of a line and its wait; 2 s at 32 Hz
  int poses = 32;         ///< poses kept
  int regions = 384;      ///< leaves and standing regions that one merging pass holds
  int links = 1024;       ///< links between them
  int borders = 512;      ///< border points between planes, at most 65534
  int curbs = 96;         ///< pieces of curb given out, at most 65535; random streets have at most 32
};

}  // namespace curbline
