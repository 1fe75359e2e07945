// Table of contents, in the order of the data's way. A user needs pipeline.hpp alone; the rest is listed for readers.
#pragma once

// clang-format off
// Shared by all.
#include "curbline/limits.hpp"                  // sizes, at compile time
#include "curbline/cell_prior.hpp"              // of the variance within a cell
#include "curbline/settings.hpp"                // geometry, noise and tuning, at run time
#include "curbline/setting_ranges.hpp"          // what each setting may be
#include "curbline/status.hpp"                  // how a call ended
#include "curbline/counters.hpp"                // what was dropped, refused, done
#include "curbline/assertion.hpp"               // what happens at a bug
#include "curbline/math.hpp"                    // exp, log, sine: the same bits everywhere
#include "curbline/frames.hpp"                  // map <- base <- tilt <- laser
#include "curbline/grid.hpp"                    // numbers of cells and planes, directions
#include "curbline/index_set.hpp"               // a set of such numbers, as bits
#include "curbline/per_cell.hpp"                // what a stage keeps for each cell

// Before the pipeline.
#include "curbline/scan_line.hpp"               // in: ranges
#include "curbline/intake/rising_times.hpp"     // what comes late; a clock that is set back
#include "curbline/intake/line_clock.hpp"       // times of lines that are stamped on arrival
#include "curbline/intake/line_queue.hpp"       // lines that wait for their tilt and pose
#include "curbline/intake/source_watch.hpp"     // whether the servo and the localisation are alive
#include "curbline/intake/nod_watch.hpp"        // whether the tilt moves
#include "curbline/intake/sight_watch.hpp"      // whether the laser sees the window

// A line to its points.
#include "curbline/intake/extrapolation.hpp"    // angles and poses beyond the newest
#include "curbline/tilt_reading.hpp"            // in: an angle of the servo
#include "curbline/intake/tilt_track.hpp"       // its readings over time, from an interrupt
#include "curbline/intake/tilt_snapshot.hpp"    // the tilt at each beam
#include "curbline/intake/sweep_turns.hpp"      // where the servo reverses
#include "curbline/sweeps.hpp"                  // what differs from sweep to sweep
#include "curbline/intake/tilt_latency.hpp"     // how late its readings are, estimated on line
#include "curbline/pose.hpp"                    // in: a pose of the robot
#include "curbline/intake/pose_track.hpp"       // poses over time, where they jump and step
#include "curbline/intake/pose_offset.hpp"      // whether a step was the robot's or its localisation's
#include "curbline/point.hpp"                   // a point, and from where it is seen
#include "curbline/intake/line_projection.hpp"  // beams to points with variance
#include "curbline/intake/map_comparison.hpp"   // a line compared with the map
#include "curbline/intake/line_intake.hpp"      // all of these together

// Points to cells.
#include "curbline/map/cell.hpp"                // normal-inverse-gamma posterior of a cell
#include "curbline/map/laser_way.hpp"           // from where a driving laser has seen the cells
#include "curbline/map/window.hpp"              // where cells lie, in the map and in memory
#include "curbline/map/next_cells.hpp"          // how far it is to the next ones
#include "curbline/map/last_seen.hpp"           // when and from where they were seen
#include "curbline/map/dem.hpp"                 // what is in them
#include "curbline/map/cell_line.hpp"           // a row or column of them
#include "curbline/map/level_cell.hpp"          // what their spread tells of a slope

// Cells to regions.
#include "curbline/regions/link.hpp"            // neighbours on a row or column
#include "curbline/regions/segmentation.hpp"    // leaves, regions
#include "curbline/regions/region_graph.hpp"    // merging by evidence
#include "curbline/regions/gain_heap.hpp"       // which merge gains most
#include "curbline/plane.hpp"                   // moments, fit
#include "curbline/regions/plane_evidence.hpp"  // whether points lie on one plane, or on two

// Regions to planes that keep their labels.
#include "curbline/planes/region_ranking.hpp"   // which regions become planes, under which labels
#include "curbline/planes/obstacles.hpp"        // which planes belong to obstacles
#include "curbline/planes/run.hpp"              // cells of one plane in line, as the laser sees them
#include "curbline/planes/strip_tally.hpp"      // what they say about a plane
#include "curbline/planes/ground.hpp"           // which planes are ground
#include "curbline/planes/clean_fit.hpp"        // fit to cells that hold one surface only
#include "curbline/planes/plane_mixture.hpp"    // all of these together
#include "curbline/planes/common_noise.hpp"     // noise that neighbouring cells share

// Labels of cells.
#include "curbline/labels/planes_near_by.hpp"   // candidate planes of a cell
#include "curbline/labels/label_site.hpp"       // beliefs and messages of a cell
#include "curbline/labels/label_field.hpp"      // belief propagation

// Labels to borders.
#include "curbline/borders/curb_stages.hpp"     // the stages that borders and curbs are found in
#include "curbline/borders/beside.hpp"          // what cells show of the ground beside a border
#include "curbline/borders/border.hpp"          // where labels change on a row or column
#include "curbline/borders/borders.hpp"         // where labels change, and chains of such points
#include "curbline/borders/plane_gap.hpp"       // where between two planes the edge lies, to a part of a cell
#include "curbline/borders/border_finder.hpp"   // all such points of the window
#include "curbline/borders/ground_end.hpp"      // edges with only one side in view

// Borders to curbs.
#include "curbline/curbs/line_fit.hpp"          // a line through borders
#include "curbline/curbs/curb.hpp"              // out: a curb
#include "curbline/curbs/plane_pair.hpp"        // the planes on both sides of a border: step or crease
#include "curbline/curbs/curb_piece.hpp"        // borders on one line
#include "curbline/curbs/corner.hpp"            // where a chain of borders goes on along another line
#include "curbline/curbs/shadow.hpp"            // of a step down
#include "curbline/curbs/line_weights.hpp"      // what a plane owes to each scan line
#include "curbline/curbs/off_plane.hpp"         // how far the ground beside a curb is off its plane
#include "curbline/curbs/step_height.hpp"       // the height of a step
#include "curbline/curbs/curb_maker.hpp"        // its kind, position and deviations
#include "curbline/curbs/bend.hpp"              // whether the ground is bent from one plane to the next
#include "curbline/curbs/surfaces.hpp"          // which planes are one bent surface, without creases
#include "curbline/curbs/duplicates.hpp"        // steps that were found twice
#include "curbline/curbs/curb_tracer.hpp"       // all of these together
#include "curbline/curbs/crossed_cells.hpp"     // cells that steps cross, for the planes of the next line

// Queries.
#include "curbline/curbs/ground_label.hpp"      // the plane of the ground under a cell
#include "curbline/curbs/curb_ahead.hpp"        // the curb that a robot meets first
#include "curbline/curbs/passability.hpp"       // where a robot may drive

// All of it, in order.
#include "curbline/workspace.hpp"               // memory that stages share
#include "curbline/pipeline.hpp"
// clang-format on
