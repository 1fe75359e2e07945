// The firmware's pipeline on the host: the same template, with limits chosen at run time by the size of the window.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "curbline/curbs/curb.hpp"
#include "curbline/pipeline.hpp"
#include "curbline/settings.hpp"
#include "map/map.hpp"
#include "robot/robot.hpp"

namespace curbline::tools {

/// Limits of the firmware boards: 40 x 40 cells, 16 planes, 1081 beams.
inline constexpr Limits board_limits{};
/// The same for live streams: room for the tilt readings of a 1 kHz servo, and for poses, for as long as a line may
/// wait for either.
inline constexpr Limits live_limits{.tilt_samples = 1024, .poses = 256};
/// For larger windows on the host. The worst case is one leaf a cell; one leaf for three cells is more than streets
/// need.
inline constexpr Limits wide_limits{.rows = 128,
                                    .cols = 128,
                                    .planes = 64,
                                    .beams = most_beams,
                                    .tilt_samples = 1024,
                                    .poses = 256,
                                    .regions = 6000,
                                    .links = 16000,
                                    .borders = 8192,
                                    .curbs = 2048};
/// The margin around the window that is mapped too for a finished map (map_cloud.hpp): one block.
inline constexpr int margin_cells = 4;
inline constexpr Limits largest_limits{.rows = most_cells + 2 * margin_cells,
                                       .cols = most_cells + 2 * margin_cells,
                                       .planes = 250,
                                       .beams = most_beams,
                                       .tilt_samples = 1024,
                                       .poses = 256,
                                       .regions = 88000,
                                       .links = 260000,
                                       .borders = 65000,
                                       .curbs = 16384};

class HostPipeline {
 public:
  virtual ~HostPipeline() = default;
  virtual bool add_tilt(const TiltReading& reading) = 0;
  virtual bool add_pose(const Pose& pose) = 0;
  virtual Status take(const ScanLine& line) = 0;
  /// The same; also appends the line's points to `out`.
  virtual Status take(const ScanLine& line, std::vector<Point>& out) = 0;
  virtual void observe(std::span<const Point> points) = 0;
  virtual int settle() = 0;
  virtual std::span<const Curb> curbs() const = 0;
  virtual const Counters& counters() const = 0;
  virtual const TiltLatency& tilt_latency() const = 0;
  /// Current position of the window, and its contents.
  virtual Grid grid() const = 0;
  virtual Map map() const = 0;
  virtual std::vector<MapCurb> map_curbs() const = 0;
};

/// Throws BadInput if the settings are refused or exceed the largest limits.
std::unique_ptr<HostPipeline> make_host_pipeline(const Settings& settings);
/// The same; errors name the robot's file.
std::unique_ptr<HostPipeline> make_host_pipeline(const Robot& robot);
/// Gives the same curbs, with room for lines that wait up to a second.
std::unique_ptr<HostPipeline> make_live_pipeline(const Robot& robot);

MapCurb to_map_curb(const Curb& curb);

}  // namespace curbline::tools
