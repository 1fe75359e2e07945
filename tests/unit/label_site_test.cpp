// The arithmetic of beliefs of one cell: what is heard, taken back, kept and said.
#include "curbline/label_site.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using Site = LabelSite<test::small_limits>;
constexpr auto none = Site::none;

/// Labels 2, 5 and 7, of which the second is `nats` less likely than the first, the third ruled out.
Site site(double nats) {
  Site s;
  s.set_labels({2, 5, 7});
  s.node = {0, static_cast<std::int16_t>(-nats * Site::node_scale), -120 * Site::node_scale};
  return s;
}

TEST_CASE("label site: what it has heard can be taken back to the bit, in any order") {
  const Site s = site(1.0);
  Site::Heard sum{};
  const Site::Labels others{7, 2, none};
  const Site::Message first{31, 12, 0}, second{3, 48, 9};
  s.hear(others, first, false, 1, sum);
  s.hear(s.label, second, true, 1, sum);
  CHECK(sum == Site::Heard{15, 48, 40});  // of 2: 12 + 3, of 5: 48, of 7: 31 + 9
  s.hear(others, first, false, -1, sum);
  CHECK(sum == Site::Heard{3, 48, 9});
  s.hear(s.label, second, true, -1, sum);
  CHECK(sum == Site::Heard{});
}

TEST_CASE("label site: what was said of a label stays with it when candidates change, and is nothing of a new one") {
  Site s = site(1.0);
  s.sent[1] = {10, 20, 30};
  s.set_labels({7, 4, 2});
  CHECK(s.sent[1] == Site::Message{30, 0, 10});
  s.set_labels({4, none, none});
  CHECK(s.sent[1] == Site::Message{});
}

TEST_CASE("label site: its belief is the softmax of its node and of what it has heard") {
  const Site s = site(1.0);
  const Site::Heard heard{0, Site::message_scale / 2, 0};  // half a nat for the second
  const Site::Probabilities p = s.probabilities(heard);
  CHECK(p[0] == Approx(1.0 / (1.0 + std::exp(-0.5))).margin(1e-5));
  CHECK(p[0] + p[1] == Approx(1.0).margin(1e-6));
  CHECK(p[2] == 0.0f);
  CHECK(s.most_likely(heard) == 2);
  CHECK(s.most_likely({0, 2 * Site::message_scale, 0}) == 5);
}

TEST_CASE("label site: one that is sure says the whole coupling, one that is not the Potts factor's share of it") {
  const Site::Coupling coupling = Site::coupling(1.5f);
  const Site::Message sure = Site::message({1.0f, 0.0f, 0.0f}, coupling);
  CHECK(sure == Site::Message{48, 0, 0});
  const Site::Message unsure = Site::message({0.75f, 0.25f, 0.0f}, coupling);
  const auto nats = [](double p) { return std::log(1.0 + (std::exp(1.5) - 1.0) * p); };
  CHECK(unsure[0] == Approx(Site::message_scale * nats(0.75)).margin(0.5));
  CHECK(unsure[1] == Approx(Site::message_scale * nats(0.25)).margin(0.5));
}

TEST_CASE("label site: one label is borne whatever is heard, and none by a site that knows none") {
  Site s;
  CHECK(s.decided());
  CHECK(s.most_likely({}) == none);
  s.set_labels({3, none, none});
  CHECK(s.decided());
  CHECK(s.most_likely({0, 100, 100}) == 3);
}

}  // namespace
}  // namespace curbline
