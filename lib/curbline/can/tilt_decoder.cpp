#include "curbline/can/tilt_decoder.hpp"

#include <atomic>

#include "curbline/intake/rising_times.hpp"

namespace curbline::can {
namespace {

/// Within them a float holds an angle, whatever the signal's number.
constexpr auto furthest_rad = static_cast<double>(TiltReading::furthest_rad);

/// How long a position may take after the first SYNC of all: a full bus delays it by a few frames, a millisecond.
constexpr std::int64_t longest_first_delay_ns = 5'000'000;

/// One writer.
void count(std::uint32_t& counter) {
  const std::atomic_ref<std::uint32_t> shared(counter);
  shared.store(shared.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

std::uint32_t read(std::uint32_t& counter) {
  return std::atomic_ref<std::uint32_t>(counter).load(std::memory_order_relaxed);
}

}  // namespace

bool TiltDecoder::init(const Signal& signal, std::optional<std::uint16_t> sync_id) {
  *this = TiltDecoder{};
  if (!valid(signal)) return false;
  if (sync_id && (*sync_id > highest_id(false) || (!signal.extended && ((*sync_id ^ signal.id) & signal.id_mask) == 0)))
    return false;
  signal_ = signal;
  sync_id_ = sync_id;
  ready_ = true;
  return true;
}

std::optional<TiltReading> TiltDecoder::take(const Frame& frame) {
  count(counters_.frames);
  if (ready_ && is_sync(frame)) {
    note_sync(frame.time_ns);
    count(counters_.syncs);
    return std::nullopt;
  }
  if (!ready_ || !carries(signal_, frame)) {
    count(counters_.others);
    return std::nullopt;
  }
  if (!RisingTimes::is_time(frame.time_ns)) {
    count(counters_.malformed);
    return std::nullopt;
  }
  const auto time_ns = time_of_position(frame.time_ns);
  const auto angle = decode(signal_, frame);
  if (!angle || !(*angle >= -furthest_rad && *angle <= furthest_rad)) {
    count(counters_.malformed);
    return std::nullopt;
  }
  if (!time_ns) {
    count(counters_.without_sync);
    return std::nullopt;
  }
  count(counters_.readings);
  return TiltReading{*time_ns, static_cast<float>(*angle)};
}

bool TiltDecoder::is_sync(const Frame& frame) const {
  return sync_id_ && frame.id == *sync_id_ && !frame.extended && !frame.remote && !frame.error &&
         RisingTimes::is_time(frame.time_ns);
}

void TiltDecoder::note_sync(std::int64_t time_ns) {
  if (sync_ns_ && time_ns > *sync_ns_) {
    gaps_ns_[next_gap_] = time_ns - *sync_ns_;
    next_gap_ = (next_gap_ + 1) % gaps_ns_.size();
    if (gaps_ < gaps_ns_.size()) ++gaps_;
  }
  sync_ns_ = time_ns;
  sync_pending_ = true;
}

/// The median of the newest gaps, the lower of the middle two; longest_first_delay_ns before there is one.
std::int64_t TiltDecoder::sync_period_ns() const {
  for (std::size_t i = 0; i < gaps_; ++i) {
    std::size_t below = 0, equal = 0;
    for (std::size_t k = 0; k < gaps_; ++k) {
      below += gaps_ns_[k] < gaps_ns_[i];
      equal += gaps_ns_[k] == gaps_ns_[i];
    }
    const std::size_t middle = (gaps_ - 1) / 2;
    if (below <= middle && middle < below + equal) return gaps_ns_[i];
  }
  return longest_first_delay_ns;
}

/// Its SYNC's time, which then is used up, or that of its arrival where there are none; nothing if the SYNC was not
/// seen.
std::optional<std::int64_t> TiltDecoder::time_of_position(std::int64_t arrival_ns) {
  if (!sync_id_) return arrival_ns;
  if (!sync_pending_) return std::nullopt;
  sync_pending_ = false;
  const std::int64_t delay_ns = arrival_ns - *sync_ns_;
  if (delay_ns < 0 || delay_ns >= sync_period_ns()) return std::nullopt;
  return sync_ns_;
}

TiltDecoderCounters TiltDecoder::counters() const {
  TiltDecoderCounters& c = counters_;
  return {read(c.frames), read(c.readings), read(c.others), read(c.syncs), read(c.malformed), read(c.without_sync)};
}

}  // namespace curbline::can
