// The arithmetic of one cell's beliefs: what it hears, takes back, keeps and sends.
#include "curbline/labels/label_site.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace curbline {
namespace {

/// Labels 2, 5 and 7. The second is `nats` less likely than the first, the third is ruled out.
LabelSite site(double nats) {
  LabelSite s;
  s.set_labels({2, 5, 7});
  s.node = {static_cast<std::int16_t>(-nats * LabelSite::node_scale), -120 * LabelSite::node_scale};
  return s;
}

TEST_CASE("label site: what it has heard can be taken back to the bit, in any order") {
  const LabelSite s = site(1.0);
  LabelSite::Heard sum{};
  const LabelSite::Labels others{7, 2, no_label};
  const LabelSite::Message first{31, 12, 0}, second{3, 48, 9};
  s.hear(others, first, 1, sum);
  s.hear(s.label, second, 1, sum);
  CHECK(sum == LabelSite::Heard{15, 48, 40});  // label 2: 12 + 3, label 5: 48, label 7: 31 + 9
  s.hear(others, first, -1, sum);
  CHECK(sum == LabelSite::Heard{3, 48, 9});
  s.hear(s.label, second, -1, sum);
  CHECK(sum == LabelSite::Heard{});
}

TEST_CASE("label site: what was said of a label stays with it when candidates change, and is nothing of a new one") {
  LabelSite s = site(1.0);
  s.sent[1] = {10, 20, 30};
  s.set_labels({7, 4, 2});
  CHECK(s.sent[1] == LabelSite::Message{30, 0, 10});
  s.set_labels({4, no_label, no_label});
  CHECK(s.sent[1] == LabelSite::Message{});
}

TEST_CASE("label site: its belief is the softmax of its node and of what it has heard") {
  const LabelSite s = site(1.0);
  const LabelSite::Heard heard{0, LabelSite::message_scale / 2, 0};  // half a nat for the second
  const LabelSite::Probabilities p = s.probabilities(heard);
  CHECK(p[0] == Approx(1.0 / (1.0 + std::exp(-0.5))).margin(1e-5));
  CHECK(p[0] + p[1] == Approx(1.0).margin(1e-6));
  CHECK(p[2] == 0.0f);
  CHECK(s.most_likely(heard) == 2);
  CHECK(s.most_likely({0, 2 * LabelSite::message_scale, 0}) == 5);
}

TEST_CASE("label site: a certain site sends the whole coupling, an uncertain one its share by the Potts factor") {
  const LabelSite::Coupling coupling = LabelSite::coupling(1.5f);
  const LabelSite::Message sure = LabelSite::message({1.0f, 0.0f, 0.0f}, coupling);
  CHECK(sure == LabelSite::Message{48, 0, 0});
  const LabelSite::Message unsure = LabelSite::message({0.75f, 0.25f, 0.0f}, coupling);
  const auto nats = [](double p) { return std::log(1.0 + (std::exp(1.5) - 1.0) * p); };
  CHECK(unsure[0] == Approx(LabelSite::message_scale * nats(0.75)).margin(0.5));
  CHECK(unsure[1] == Approx(LabelSite::message_scale * nats(0.25)).margin(0.5));
}

TEST_CASE("label site: a site that knows one label keeps it whatever is heard, and one that knows none has none") {
  LabelSite s;
  CHECK(s.decided());
  CHECK(s.most_likely({}) == no_label);
  s.set_labels({3, no_label, no_label});
  CHECK(s.decided());
  CHECK(s.most_likely({0, 100, 100}) == 3);
}

}  // namespace
}  // namespace curbline
