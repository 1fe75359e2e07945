// The user's program of the README, with data: synthetic scan lines of a street of two planes.
#include <curbline/curbline.hpp>

#include <array>
#include <cstdio>

namespace {

constexpr curbline::Limits limits{};
curbline::Pipeline<limits> pipeline;

/// Range to a road at z = 0 that steps up by 0.12 m at x = 2, from a laser 1 m above it that looks down by `tilt`.
float range_m(float bearing_rad, float tilt_rad) {
  const auto bearing = curbline::sin_cos(bearing_rad), tilt = curbline::sin_cos(tilt_rad);
  const float down = bearing.cos * tilt.sin, ahead = bearing.cos * tilt.cos;
  if (down <= 0.0f) return 0.0f;
  const float road = 1.0f / down;
  if (road * ahead < 2.0f) return road;
  const float pavement = 0.88f / down;
  return pavement * ahead >= 2.0f ? pavement : 2.0f / ahead;  // else the face between them
}

}  // namespace

int main() {
  curbline::Settings settings;
  settings.laser.beams = 361;
  settings.laser.first_bearing_rad = -1.5f;
  settings.laser.bearing_step_rad = 3.0f / 360.0f;
  settings.laser.beam_interval_s = 0.0f;
  settings.tilt.T_base_tilt.z_m = 1.0f;
  if (const auto status = pipeline.init(settings); status != curbline::Status::ok) {
    std::printf("init: %s\n", to_string(status));
    return 1;
  }
  for (int line = 0; line < 300; ++line) {
    const std::int64_t time_ns = line * 25'000'000LL;
    const float tilt_rad = 0.2f + 0.003f * static_cast<float>(line);
    pipeline.add_tilt({time_ns, tilt_rad});
    std::array<float, 361> ranges{};
    for (std::size_t i = 0; i < ranges.size(); ++i)
      ranges[i] = range_m(-1.5f + static_cast<float>(i) * 3.0f / 360.0f, tilt_rad);
    pipeline.take({time_ns, ranges});
  }
  for (const auto& curb : pipeline.curbs()) {
    std::printf("(%.2f %.2f) - (%.2f %.2f): %.3f m +- %.3f, %s\n", static_cast<double>(curb.x0_m),
                static_cast<double>(curb.y0_m), static_cast<double>(curb.x1_m), static_cast<double>(curb.y1_m),
                static_cast<double>(curb.height_m), static_cast<double>(curb.height_sd_m), to_string(curb.kind));
    if (curb.kind == curbline::CurbKind::step_up && curb.height_m > 0.11f && curb.height_m < 0.13f) return 0;
  }
  std::printf("no curb of 0.12 m among %zu\n", pipeline.curbs().size());
  return 1;
}
