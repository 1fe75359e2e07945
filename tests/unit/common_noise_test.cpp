// The share of a cell's noise that is common to its points, recovered from fields of known variance and correlation.
#include "curbline/planes/common_noise.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "support/small_map.hpp"

namespace curbline {
namespace {

using test::Stages;

constexpr Limits limits{};
constexpr std::size_t side = 40;

Settings map_settings() {
  return test::small_settings(side, side);
}

/// Deviation of each cell from its plane: a first-order autoregression along both axes.
class Unevenness {
 public:
  Unevenness(double sd_m, double r_x, double r_y, std::uint32_t seed = 1) {
    test::Noise noise(seed);
    const double fresh_x = std::sqrt(1.0 - r_x * r_x), fresh_y = std::sqrt(1.0 - r_y * r_y);
    std::array<std::array<double, side>, side> along_y{};
    for (std::size_t i = 0; i < side; ++i) {
      for (std::size_t j = 0; j < side; ++j) {
        const double fresh = noise.normal();
        along_y[i][j] = j == 0 ? fresh : r_y * along_y[i][j - 1] + fresh_y * fresh;
        at_[i][j] = i == 0 ? along_y[0][j] : r_x * at_[i - 1][j] + fresh_x * along_y[i][j];
      }
    }
    for (auto& row : at_) {
      for (double& off : row) off *= sd_m;
    }
  }
  double operator()(double x_m, double y_m) const {
    return at_[static_cast<std::size_t>(x_m * 10.0)][static_cast<std::size_t>(y_m * 10.0)];
  }

 private:
  std::array<std::array<double, side>, side> at_{};
};

/// The estimate after every patch has been examined.
CommonNoise<limits> noise_of(const Stages<limits>& stages) {
  CommonNoise<limits> common_noise;
  common_noise.init();
  for (int row = 0; row < stages.dem.rows(); row += PatchResiduals::side) {
    common_noise.follow(stages.dem, stages.mixture);
  }
  return common_noise;
}

float share_of(const Stages<limits>& stages, const PlanePrior& prior, float latency_sd_s = 0.0f) {
  return noise_of(stages).common_m2(prior, latency_sd_s) / prior.noise_m2;
}

/// Share found on a map of these heights, with no limit from the settings.
template <typename Height>
float share_of(Height&& height_m) {
  Stages<limits> stages(map_settings());
  test::fill(stages.dem, height_m);
  stages.infer(true);
  PlanePrior prior;
  prior.common_share = 100.0f;
  return share_of(stages, prior);
}

/// Median of many patches, each on a sloping plane.
double of_patches(double r_x, double r_y) {
  constexpr auto patch_side = static_cast<std::size_t>(PatchResiduals::side);
  std::vector<double> found;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Unevenness off(0.004, r_x, r_y, seed);
    const auto above_m = [&](std::size_t i, std::size_t j) {
      const auto x = static_cast<double>(i), y = static_cast<double>(j);
      return static_cast<float>(off(0.1 * x + 0.05, 0.1 * y + 0.05) + 0.01 + 0.003 * x - 0.002 * y);
    };
    for (std::size_t first_i = 0; first_i < side; first_i += patch_side) {
      for (std::size_t first_j = 0; first_j < side; first_j += patch_side) {
        PatchResiduals patch;
        for (std::size_t i = first_i; i < first_i + patch_side; ++i) {
          for (std::size_t j = first_j; j < first_j + patch_side; ++j) {
            patch.add(static_cast<float>(i - first_i), static_cast<float>(j - first_j), above_m(i, j), {});
            if (i > first_i) patch.add_rise(0, above_m(i, j) - above_m(i - 1, j));
            if (j > first_j) patch.add_rise(1, above_m(i, j) - above_m(i, j - 1));
          }
        }
        found.push_back(static_cast<double>(patch.noise().common_m2));
      }
    }
  }
  std::nth_element(found.begin(), found.begin() + found.size() / 2, found.end());
  return found[found.size() / 2];
}

TEST_CASE(
    "common noise: what a patch shares of cells that err each on its own is their variance, on whatever plane it "
    "lies") {
  CHECK(of_patches(0.0, 0.0) == Approx(0.16e-4).epsilon(0.15));
}

TEST_CASE("common noise: of stripes a patch shares more by (1 + r) / (1 - r), of blots by its square") {
  CHECK(of_patches(0.5, 0.0) == Approx(0.48e-4).epsilon(0.15));
  CHECK(of_patches(0.0, 0.5) == Approx(0.48e-4).epsilon(0.15));
  CHECK(of_patches(0.5, 0.5) == Approx(1.44e-4).epsilon(0.25));
}

TEST_CASE("common noise: cells that lie on their plane share nothing") {
  PatchResiduals patch;
  for (int i = 0; i < PatchResiduals::side; ++i) {
    for (int j = 0; j < 2; ++j) patch.add(static_cast<float>(i), static_cast<float>(j), 0.0f, {});
  }
  CHECK(patch.noise().common_m2 == 0.0f);
}

TEST_CASE("common noise: the share is that of the evener patches") {
  const auto at_most_by_half_less = [](float share, double expected) {
    CHECK(share > 0.5 * expected);
    CHECK(share < 1.05 * expected);
  };
  at_most_by_half_less(share_of(Unevenness(0.004, 0.0, 0.0)), 0.16);
  at_most_by_half_less(share_of(Unevenness(0.008, 0.0, 0.0)), 0.64);
  at_most_by_half_less(share_of(Unevenness(0.004, 0.5, 0.0)), 0.48);
  at_most_by_half_less(share_of(Unevenness(0.004, 0.0, 0.5)), 0.48);
}

TEST_CASE("common noise: a step by which no planes are parted yet does not pass for it") {
  const Unevenness even(0.003, 0.0, 0.0);
  Stages<limits> stages(map_settings());
  test::fill(stages.dem, [&](double x_m, double y_m) { return even(x_m, y_m) + (x_m + y_m < 4.0 ? 0.0 : 0.012); });
  stages.infer(true);
  CHECK(stages.label_at(2, 2) == stages.label_at(37, 37));
  CHECK(share_of(stages, PlanePrior{}) < 0.3f);
}

TEST_CASE("common noise: three steps across three quarters of the window do not pass for it either") {
  const Unevenness even(0.003, 0.0, 0.0);
  Stages<limits> stages(map_settings());
  test::fill(stages.dem, [&](double x_m, double y_m) {
    return even(x_m, y_m) + (x_m > 0.5) * 0.011 - (x_m > 1.5) * 0.011 + (x_m > 2.5) * 0.011;
  });
  stages.infer(true);
  CHECK(stages.label_at(2, 2) == stages.label_at(37, 37));
  CHECK(share_of(stages, PlanePrior{}) < 0.3f);
}

TEST_CASE("common noise: cells that are no neighbours do not tell how alike neighbours are") {
  const Unevenness stripes(0.004, 0.5, 0.0);
  Stages<limits> stages(map_settings());
  for (std::size_t i = 0; i < side; i += 2) {
    for (std::size_t j = 0; j < side; ++j) {
      const double x_m = 0.1 * static_cast<double>(i) + 0.05, y_m = 0.1 * static_cast<double>(j) + 0.05;
      const auto z_m = static_cast<float>(stripes(x_m, y_m));
      for (int k = 0; k < 4; ++k) stages.dem.add({static_cast<float>(x_m), static_cast<float>(y_m), z_m, 1e-4f});
    }
  }
  stages.infer(true);
  CHECK(share_of(stages, PlanePrior{}) == Approx(0.12).epsilon(0.4));  // 0.16 from all patches, 0.48 with correlations
}

/// Lines of cells that err alike by sd_m(points), across this way ahead; three quarters of the window have 16 points a
/// cell, the last one has one.
CommonNoise<limits> noise_of_lines(const std::function<double(int)>& sd_m, double ahead_rad = 0.0,
                                   double cell_y_m = 0.1) {
  const SinCos ahead{static_cast<float>(std::sin(ahead_rad)), static_cast<float>(std::cos(ahead_rad))};
  std::array<double, 2 * side> line{};
  test::Noise noise(1);
  for (double& off : line) off = noise.normal();
  Settings settings = map_settings();
  settings.window.cell_y_m = static_cast<float>(cell_y_m);
  const double line_m = 0.5 * (0.1 + cell_y_m);
  Stages<limits> stages(settings);
  stages.dem.look_from(0.0f, 0.0f, ahead);
  for (std::size_t i = 0; i < side; ++i) {
    const int points = i < 3 * side / 4 ? 16 : 1;
    for (std::size_t j = 0; j < side; ++j) {
      const double x_m = 0.1 * (static_cast<double>(i) + 0.5), y_m = cell_y_m * (static_cast<double>(j) + 0.5);
      const double ahead_m = x_m * std::cos(ahead_rad) + y_m * std::sin(ahead_rad);
      const auto z_m = static_cast<float>(sd_m(points) * line[static_cast<std::size_t>(ahead_m / line_m)]);
      for (int k = 0; k < points; ++k) stages.dem.add({static_cast<float>(x_m), static_cast<float>(y_m), z_m, 1e-4f});
    }
  }
  stages.infer(true);
  return noise_of(stages);
}

TEST_CASE("common noise: what scan lines err is found, whichever way they run") {
  const double ahead_rad = GENERATE(0.0, 0.5, 0.7854, 1.2, 1.5708);
  const double cell_y_m = GENERATE(0.1, 0.05);
  INFO(ahead_rad << " rad, cells of 0.1 x " << cell_y_m << " m");
  const auto sd_m = [](int points) { return 0.004 / std::sqrt(points); };
  const CommonNoise<limits> noise = noise_of_lines(sd_m, ahead_rad, cell_y_m);
  // Aslant, or if cells are not as long as lines lie apart, a row of cells holds parts of two lines.
  CHECK(noise.line_m2() > (cell_y_m < 0.1 ? 0.4f : 0.5f) * 1.6e-5f);
  CHECK(noise.line_m2() < 2.0f * 1.6e-5f);  // by chance, of ten lines
}

TEST_CASE("common noise: cells that err each on its own are not taken for lines that do") {
  Stages<limits> stages(map_settings());
  const Unevenness even(0.004, 0.0, 0.0);
  test::fill(stages.dem, [&](double x_m, double y_m) { return even(x_m, y_m); });
  stages.infer(true);
  const double points = 25.0;  // of fill()
  CHECK(static_cast<double>(noise_of(stages).line_m2()) / points < 0.1 * 1.6e-5);
}

TEST_CASE("common noise: ground that is uneven alike everywhere is not taken for what scan lines err") {
  CHECK(noise_of_lines([](int) { return 0.001; }).line_m2() < 4e-6f);  // 1.6e-5 if patches counted alike
}

TEST_CASE("common noise: what is not known of the tilt's latency is common to all that a sweep has seen") {
  Stages<limits> stages(map_settings());
  for (std::size_t i = 0; i < side; ++i) {
    for (std::size_t j = 0; j < side; ++j) {
      Point point{0.1f * static_cast<float>(i) + 0.05f, 0.1f * static_cast<float>(j) + 0.05f, 0.0f, 1e-4f};
      point.growth_m_s = 0.8f;
      stages.dem.add(point);
    }
  }
  stages.infer(true);
  PlanePrior prior;
  prior.common_share = 1.0f;
  const auto share = [&](float latency_sd_s) { return share_of(stages, prior, latency_sd_s); };
  CHECK(share(0.01f) == Approx(0.64).epsilon(0.01));
  CHECK(share(0.001f) == PlanePrior::least_common_share);
}

TEST_CASE("common noise: uneven ground has no say as long as a quarter is even") {
  const Unevenness even(0.003, 0.0, 0.0), uneven(0.01, 0.5, 0.5);
  const auto most = [](float at_m) { return [=](double x_m, double) { return x_m < static_cast<double>(at_m); }; };
  const auto ground = [&](auto&& on_even) {
    return
        [&, on_even](double x_m, double y_m) { return on_even(x_m, y_m) ? even(x_m, y_m) : 0.25 + uneven(x_m, y_m); };
  };
  CHECK(share_of(ground(most(1.0f))) < 0.2f);
  CHECK(share_of(ground(most(0.6f))) > 1.0f);
}

TEST_CASE("common noise: it lies between the least share and that of the settings, which holds where no plane is") {
  Stages<limits> stages(map_settings());
  const PlanePrior prior;
  const auto share = [&] { return share_of(stages, prior); };
  CHECK(share() == prior.common_share);
  test::fill(stages.dem, [](double, double) { return 0.0; });
  stages.infer(true);
  CHECK(share() == PlanePrior::least_common_share);
  Stages<limits> rough(map_settings());
  test::fill(rough.dem, Unevenness(0.01, 0.5, 0.5));
  rough.infer(true);
  CHECK(share_of(rough, prior) == prior.common_share);
}

TEST_CASE("common noise: a patch of which a triangle alone is seen shares no more, however its plane is tilted") {
  const auto shared_m2 = [](double tilt_x, double tilt_y) {
    const Unevenness off(0.004, 0.5, 0.5);
    PatchResiduals patch;
    const auto above_m = [&](int i, int j) {
      return static_cast<float>(off(0.1 * i + 0.05, 0.1 * j + 0.05) + tilt_x * i + tilt_y * j);
    };
    for (int i = 0; i < PatchResiduals::side; ++i) {
      for (int j = 0; j <= i; ++j) {
        patch.add(static_cast<float>(i), static_cast<float>(j), above_m(i, j), {});
        if (j < i) patch.add_rise(0, above_m(i, j) - above_m(i - 1, j));
        if (j > 0) patch.add_rise(1, above_m(i, j) - above_m(i, j - 1));
      }
    }
    return static_cast<double>(patch.noise().common_m2);
  };
  const double level_m2 = shared_m2(0.0, 0.0);
  CHECK(level_m2 > 1e-6);
  for (const auto& [tilt_x, tilt_y] : {std::pair{0.004, 0.0}, {0.0, 0.004}, {0.003, -0.005}})
    CHECK(shared_m2(tilt_x, tilt_y) == Approx(level_m2).epsilon(0.02));
}

}  // namespace
}  // namespace curbline
