#include "latency_histogram.hpp"

#include <catch2/catch.hpp>

namespace curbline::daemon {
namespace {

TEST_CASE("latency histogram: each duration is in the bucket whose ends lie about it") {
  for (std::uint64_t us = 0; us < 40'000'000; us += 1 + us / 100) {
    LatencyHistogram h;
    h.add(static_cast<std::int64_t>(us) * 1000 + 999);
    std::size_t bucket = 0;
    while (h.count(bucket) == 0) ++bucket;
    REQUIRE(us < LatencyHistogram::end_us(bucket));
    REQUIRE(us >= (bucket == 0 ? 0 : LatencyHistogram::end_us(bucket - 1)));
  }
}

TEST_CASE("latency histogram: quantiles, mean and the longest") {
  LatencyHistogram h;
  CHECK(h.quantile_us(990) == 0);
  for (int us = 1; us <= 1000; ++us) h.add(us * 1000);
  CHECK(h.samples() == 1000);
  CHECK(h.mean_us() == 500);
  CHECK(h.quantile_us(500) >= 500);
  CHECK(h.quantile_us(500) <= 640);
  CHECK(h.quantile_us(1000) == 1000);
  CHECK(h.longest_us() == 1000);
}

TEST_CASE("latency histogram: no quantile is above the longest") {
  for (int us = 0; us < 200; ++us) {
    LatencyHistogram h;
    for (int k = 0; k < 100; ++k) h.add(us * 1000);
    REQUIRE(h.quantile_us(990) == h.longest_us());
  }
}

TEST_CASE(
    "latency histogram: times below 0, of a clock that was set, and beyond the last bucket are kept at the ends") {
  LatencyHistogram h;
  h.add(-5);
  h.add(INT64_MAX);
  CHECK(h.count(0) == 1);
  CHECK(h.count(LatencyHistogram::buckets - 1) == 1);
}

}  // namespace
}  // namespace curbline::daemon
