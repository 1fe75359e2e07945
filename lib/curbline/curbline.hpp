// Table of contents, in the order of the data's way. A user needs pipeline.hpp; the rest is there to be read.
#pragma once

// clang-format off
#include "curbline/limits.hpp"           // sizes, at compile time
#include "curbline/grid.hpp"             // numbers of cells and planes, directions
#include "curbline/per_cell.hpp"         // what a stage keeps for each cell
#include "curbline/settings.hpp"         // geometry, noise and tuning, at run time
#include "curbline/status.hpp"           // how a call ended
#include "curbline/counters.hpp"         // what was dropped, refused, done
#include "curbline/frames.hpp"           // map <- base <- tilt <- laser
#include "curbline/scan_line.hpp"        // in: ranges
#include "curbline/rising_times.hpp"     // what comes late, a clock that is set back
#include "curbline/extrapolation.hpp"    // how angles and poses go on
#include "curbline/tilt_reading.hpp"     // in: a servo angle
#include "curbline/tilt_track.hpp"       // they over time
#include "curbline/tilt_snapshot.hpp"    // the angle at each beam of a line
#include "curbline/tilt_watch.hpp"       // whether the servo is alive
#include "curbline/line_clock.hpp"       // lines that bear the time of their arrival
#include "curbline/line_queue.hpp"       // lines that wait for their tilt
#include "curbline/sweep_turns.hpp"      // where the servo turns round
#include "curbline/tilt_latency.hpp"     // how late they are, found on the way
#include "curbline/pose.hpp"             // in: a robot pose
#include "curbline/pose_track.hpp"       // they over time, jumps and steps
#include "curbline/pose_offset.hpp"      // whether a jump was the robot's
#include "curbline/line_projection.hpp"  // beams to points with variance
#include "curbline/point.hpp"            //
#include "curbline/cell.hpp"             // normal-inverse-gamma posterior of a cell
#include "curbline/viewpoints.hpp"       // from where a robot that drives has seen them
#include "curbline/window.hpp"           // where cells lie, in the map and in memory
#include "curbline/dem.hpp"              // what is in them
#include "curbline/link.hpp"             // neighbours on a row or column
#include "curbline/segmentation.hpp"     // leaves, regions
#include "curbline/region_graph.hpp"     // merging by evidence
#include "curbline/plane.hpp"            // moments, fit
#include "curbline/plane_evidence.hpp"   // that points lie on one, or on two that are parted
#include "curbline/region_ranking.hpp"   // which regions become planes, under which labels
#include "curbline/clean_fit.hpp"        // of cells that hold nothing else
#include "curbline/plane_mixture.hpp"    // labels that live on
#include "curbline/common_noise.hpp"     // what their cells err alike
#include "curbline/obstacles.hpp"        // which planes are of what stands on the ground
#include "curbline/run.hpp"              // cells of one plane in line, as the laser sees them
#include "curbline/strip_tally.hpp"      // what they tell of a plane
#include "curbline/ground.hpp"           // which planes are ground
#include "curbline/planes_near_by.hpp"   // which a cell may bear
#include "curbline/label_site.hpp"       // beliefs and messages of a cell
#include "curbline/label_field.hpp"      // belief propagation
#include "curbline/map_comparison.hpp"   // what a line says against the map: to tilt_latency, pose_offset
#include "curbline/line_intake.hpp"      // from a line to its points: the tracks, the projection, what they are off by
#include "curbline/index_set.hpp"        // planes near by, cells that changed, as bits
#include "curbline/beside.hpp"           // the ground beside them
#include "curbline/cell_line.hpp"        // a row or column
#include "curbline/curb_stages.hpp"      // what curbs are found in
#include "curbline/borders.hpp"          // where labels change
#include "curbline/border_finder.hpp"    // to a part of a cell
#include "curbline/ground_end.hpp"       // edges of which only one side is seen
#include "curbline/curb.hpp"             // out: a curb
#include "curbline/line_fit.hpp"         // a straight piece of it
#include "curbline/shadow.hpp"           // of a step down
#include "curbline/curb_piece.hpp"       // borders on one line
#include "curbline/curb_maker.hpp"       // how high it is, where, how well that is known
#include "curbline/curb_tracer.hpp"      // from borders to curbs
#include "curbline/crossed_cells.hpp"    // where steps go, for the planes of the next line
#include "curbline/ground_label.hpp"     // which plane the ground under a cell is of
#include "curbline/passability.hpp"      // where a robot may drive
#include "curbline/workspace.hpp"        // memory that stages share
#include "curbline/math.hpp"             // exp, log, sine: the same bits everywhere
#include "curbline/pipeline.hpp"         // all of it, in order
// clang-format on
