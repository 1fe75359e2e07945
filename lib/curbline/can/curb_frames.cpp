#include "curbline/can/curb_frames.hpp"

#include <array>

#include "curbline/math.hpp"

namespace curbline::can {
namespace {

enum Field { distance, lateral, height, height_sd, kind, probability, counter, tilt, curbs, fields };

constexpr Signal field(std::uint32_t id, int start_bit, int length, double scale, bool is_signed = false) {
  return {.id = id,
          .start_bit = static_cast<std::uint16_t>(start_bit),
          .length = static_cast<std::uint8_t>(length),
          .is_signed = is_signed,
          .scale = scale};
}

constexpr double millimetre = 0.001;

constexpr double furthest_m = 65.534;  // one count below all ones, which is that of nothing ahead
constexpr int tilt_rests = 3;          // one more than SourceState has
constexpr double widest_m = 32.767, highest_m = 32.767;

constexpr std::array<CurbField, fields> layout{{
    {"CurbAhead", "Distance", "m", "Ahead of the robot to the nearest point of the curb; all ones: nothing ahead.",
     field(curb_ahead_id, 0, 16, millimetre), 0, furthest_m},
    {"CurbAhead", "Lateral", "m", "Left of the robot to that point.", field(curb_ahead_id, 16, 16, millimetre, true),
     -widest_m, widest_m},
    {"CurbAhead", "Height", "m", "Far side less near side: above 0 is a step up.",
     field(curb_ahead_id, 32, 16, millimetre, true), -highest_m, highest_m},
    {"CurbAhead", "HeightSd", "m", "Standard deviation of the height; the highest is that or more.",
     field(curb_ahead_id, 48, 8, millimetre), 0, 0.255},
    {"CurbAhead", "Kind", "", "0 nothing ahead, 1 step up, 2 step down, 3 crease or edge of a ramp.",
     field(curb_ahead_id, 56, 2, 1.0), 0, 3},
    {"CurbAhead", "Probability", "", "That the ground on both sides is not one plane.",
     field(curb_ahead_id, 58, 6, 0.02), 0, 1},
    {"CurbStatus", "Counter", "", "One more with each CurbAhead, which is not to be trusted while it stands.",
     field(curb_status_id, 0, 8, 1.0), 0, 255},
    {"CurbStatus", "Tilt", "",
     "The tilt servo: 0 never seen, 1 ok or none, 2 stale, 3 at rest, or its encoder is stuck.",
     field(curb_status_id, 8, 2, 1.0), 0, tilt_rests},
    {"CurbStatus", "Curbs", "", "In the window; 255 is that or more.", field(curb_status_id, 16, 8, 1.0), 0, 255},
}};

/// Clamped to the field's range; NaN is its minimum.
void put(Field which, double value, Frame& frame) {
  const CurbField& f = layout[which];
  const double in_range = value > f.maximum ? f.maximum : value > f.minimum ? value : f.minimum;
  encode(f.signal, in_range, frame);
}

/// Of a frame that is long enough.
float get(Field which, const Frame& frame) {
  return static_cast<float>(decode(layout[which].signal, frame).value_or(0.0));
}

bool has(Field last, const Frame& frame) {
  return carries(layout[last].signal, frame) && frame.length >= bytes_needed(layout[last].signal);
}

bool can_be_sent(const CurbAhead& curb) {
  return is_finite(curb.distance_m) && is_finite(curb.lateral_m) && is_finite(curb.height_m);
}

/// Do they differ in none of these bits, nor in the last five, by which an ODrive tells its frames apart?
bool same_node(std::uint32_t id, std::uint32_t mask) {
  return ((id ^ curb_ahead_id) & mask & ~std::uint32_t{0x1F}) == 0;
}

}  // namespace

bool shares_ids(const Signal& tilt, std::optional<std::uint16_t> sync_id) {
  return (!tilt.extended && same_node(tilt.id, tilt.id_mask)) || (sync_id && same_node(*sync_id, highest_id(false)));
}

Frame curb_ahead_frame(const std::optional<CurbAhead>& curb) {
  Frame frame;
  const bool ahead = curb && can_be_sent(*curb);
  const CurbAhead c = ahead ? *curb : CurbAhead{};
  put(distance, static_cast<double>(c.distance_m), frame);
  put(lateral, static_cast<double>(c.lateral_m), frame);
  put(height, static_cast<double>(c.height_m), frame);
  put(height_sd, is_finite(c.height_sd_m) ? static_cast<double>(c.height_sd_m) : 1.0, frame);
  put(kind, ahead ? static_cast<double>(c.kind) + 1.0 : 0.0, frame);
  put(probability, static_cast<double>(c.probability), frame);
  if (!ahead) encode(layout[distance].signal, 2 * furthest_m, frame);
  return frame;
}

Frame curb_status_frame(const CurbStatus& status) {
  Frame frame;
  put(counter, static_cast<double>(status.counter), frame);
  const bool rests = status.resting && status.tilt == SourceState::ok;
  put(tilt, rests ? tilt_rests : static_cast<double>(status.tilt), frame);
  put(curbs, static_cast<double>(status.curbs), frame);
  return frame;
}

bool read_curb_ahead(const Frame& frame, std::optional<CurbAhead>& curb) {
  if (!has(probability, frame)) return false;
  curb.reset();
  const auto which = static_cast<int>(get(kind, frame));
  if (which == 0) return true;
  curb = CurbAhead{get(distance, frame),
                   get(lateral, frame),
                   get(height, frame),
                   get(height_sd, frame),
                   static_cast<CurbKind>(which - 1),
                   get(probability, frame)};
  return true;
}

bool read_curb_status(const Frame& frame, CurbStatus& status) {
  if (!has(curbs, frame)) return false;
  const auto state = static_cast<int>(get(tilt, frame));
  const bool rests = state == tilt_rests;
  status = {static_cast<std::uint8_t>(get(counter, frame)), rests ? SourceState::ok : static_cast<SourceState>(state),
            static_cast<std::uint32_t>(get(curbs, frame)), rests};
  return true;
}

std::span<const CurbField> curb_fields() {
  return layout;
}

}  // namespace curbline::can
