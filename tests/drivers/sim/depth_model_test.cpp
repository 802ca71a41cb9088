// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/depth_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/drivers/sim/panel_scene.hpp"

namespace calibrd::sim {
namespace {

constexpr int kRow = 205;

/// Mean and standard deviation over time of the pixels around one, and the correlation of neighbours. mm
struct Statistics {
  double mean = 0, deviation = 0, neighbours = 0;
};

Statistics statistics(test::PanelScene scene, int x, int frames = 60) {
  SensorModel model(scene.cell, scene.sensor().camera);
  constexpr int kHalf = 10;
  double n = 0, sum = 0, squares = 0, products = 0;
  for (int f = 0; f < frames; ++f) {
    const auto depth = test::expose(model, scene.state, static_cast<std::uint64_t>(f)).depth_mm;
    for (int dy = -kHalf; dy <= kHalf; ++dy)
      for (int dx = -kHalf; dx <= kHalf; ++dx) {
        const auto error = [&](int px) {
          const auto at = scene.at(px, kRow + dy);
          return depth[at] - 1000.0 * static_cast<double>(model.truth().depth_m[at]);
        };
        const double here = error(x + dx), beside = error(x + dx + 1);
        n += 1;
        sum += here;
        squares += here * here;
        products += here * beside;
      }
  }
  const double mean = sum / n, variance = squares / n - mean * mean;
  return {mean, std::sqrt(variance), (products / n - mean * mean) / variance};
}

/// Each pixel's depth in mm for a scene, beside the truth.
template <class Check>
void each_pixel(test::PanelScene scene, Check check, std::int64_t now_ns = 1'000'000'000) {
  SensorModel model(scene.cell, scene.sensor().camera);
  const auto depth = test::expose(model, scene.state, 1, now_ns).depth_mm;
  for (std::size_t i = 0; i < depth.size(); ++i)
    check(depth[i], static_cast<double>(model.truth().depth_m[i]));
}

TEST(AxialNoise, IsFankhausersFormula) {
  EXPECT_NEAR(axial_noise_m(1.0, 0), 1.30e-3, 1e-6);
  EXPECT_NEAR(axial_noise_m(1.34, 0), 1.37e-3, 5e-6);
  EXPECT_NEAR(axial_noise_m(2.0, 0), 1.70e-3, 1e-6);
  EXPECT_NEAR(axial_noise_m(1.34, 60 * std::numbers::pi / 180), 2.0e-3, 5e-5);
  EXPECT_NEAR(axial_noise_m(1.34, 75 * std::numbers::pi / 180), 5.2e-3, 1e-4);
}

TEST(DepthModel, WithoutErrorsIsExactToTheRounding) {
  each_pixel(test::wall(1.4, 0.5), [](double mm, double z) { ASSERT_NEAR(mm, 1000 * z, 0.5001); });
}

TEST(DepthModel, NoiseFollowsTheFormula) {
  constexpr double kRounding = 1.0 / 12;  // variance of whole mm
  for (const double z : {1.0, 1.34, 2.0})
    for (const int correlated : {0, 1}) {
      test::PanelScene scene = test::wall(z);
      scene.sensor().depth.noise = 1;
      scene.sensor().depth.correlated = correlated;
      const Statistics seen = statistics(scene, 255);
      const double sigma = 1000 * axial_noise_m(z, 0);
      EXPECT_NEAR(seen.deviation, std::sqrt(sigma * sigma + kRounding), 0.05 * sigma) << z;
      EXPECT_NEAR(seen.mean, 0, 0.06);
      EXPECT_NEAR(seen.neighbours, correlated != 0 ? 2.0 / 3 * 0.97 : 0.0, 0.05);
    }
}

TEST(DepthModel, NoiseGrowsWithIncidence) {
  const double turn = 60 * std::numbers::pi / 180;
  test::PanelScene scene = test::wall(1.34, turn);
  scene.sensor().depth.noise = 1;
  const Statistics seen = statistics(scene, 255);
  EXPECT_NEAR(seen.deviation, 1000 * axial_noise_m(1.34, turn), 0.15);
}

TEST(DepthModel, OffsetScaleAndWiggleAreSystematic) {
  test::PanelScene scene = test::wall(1.6, 0.7);
  DepthErrors& e = scene.sensor().depth;
  e.offset_m = 0.018;
  e.scale = 1.004;
  e.wiggle_m = 0.006;
  e.wiggle_period_m = 0.8;
  e.wiggle_phase_rad = 0.4;
  each_pixel(scene, [](double mm, double z) {
    const double expected = 1.004 * z + 0.018 + 0.006 * std::sin(2 * std::numbers::pi * z / 0.8 + 0.4);
    ASSERT_NEAR(mm, 1000 * expected, 0.501);
  });
}

TEST(DepthModel, WarmUpDriftDiesAway) {
  test::PanelScene scene = test::wall(1.5);
  scene.sensor().depth.warmup_m = 0.02;
  scene.sensor().depth.warmup_s = 100;
  for (const double age_s : {0.0, 100.0, 1000.0})
    each_pixel(
        scene, [&](double mm, double z) { ASSERT_NEAR(mm, 1000 * z + 20 * std::exp(-age_s / 100), 0.51); },
        static_cast<std::int64_t>(age_s * 1e9));
}

TEST(DepthModel, CuttingOffIsHalfAMillimetreShortOnAverage) {
  test::PanelScene scene = test::wall(1.5, 0.4);
  scene.sensor().depth.truncated = 1;
  double sum = 0, n = 0;
  each_pixel(scene, [&](double mm, double z) {
    sum += mm - 1000 * z;
    n += 1;
  });
  EXPECT_NEAR(sum / n, -0.5, 0.02);
}

TEST(DepthModel, ReportsNothingOutOfRange) {
  test::PanelScene scene = test::wall(1.5, 1.0);
  scene.sensor().depth.min_range_m = 1.2;
  scene.sensor().depth.max_range_m = 2.0;
  int nearer = 0, farther = 0;
  each_pixel(scene, [&](double mm, double z) {
    nearer += z < 1.199;
    farther += z > 2.001;
    if (z < 1.199 || z > 2.001) {
      ASSERT_EQ(mm, 0);
    }
    if (z > 1.201 && z < 1.999) {
      ASSERT_NEAR(mm, 1000 * z, 0.5001);
    }
  });
  EXPECT_GT(nearer, 1000);
  EXPECT_GT(farther, 1000);
}

TEST(DepthModel, DropOutsAreAsManyAsTold) {
  test::PanelScene scene = test::wall(1.5);
  scene.sensor().depth.dropout = 0.05;
  int dropped = 0;
  each_pixel(scene, [&](double mm, double) { dropped += mm == 0; });
  EXPECT_NEAR(dropped / (512.0 * 424), 0.05, 0.003);
}

TEST(DepthModel, GrazingSurfacesDropOutMoreAndMore) {
  test::PanelScene scene = test::wall(2.0, 70 * std::numbers::pi / 180);
  scene.sensor().depth.grazing_deg = 60;
  SensorModel model(scene.cell, scene.sensor().camera);
  const auto depth = test::expose(model, scene.state).depth_mm;
  double seen[3] = {}, dropped[3] = {};  // below 60 degrees, 60 to 75, above 75
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (model.truth().depth_m[i] == 0) continue;
    const double degrees = std::acos(model.truth().cosine[i]) * 180 / std::numbers::pi;
    const std::size_t band = degrees < 60 ? 0 : degrees < 75 ? 1 : 2;
    seen[band] += 1;
    dropped[band] += depth[i] == 0;
  }
  EXPECT_EQ(dropped[0], 0);
  EXPECT_GT(dropped[1] / seen[1], 0.1);
  EXPECT_GT(dropped[2] / seen[2], dropped[1] / seen[1]);
}

/// Pixels of the edge of a panel at 1 m before a wall at 2 m, by what they report.
struct EdgePixels {
  int dropped = 0, between = 0, clean = 0;
};

EdgePixels edge_pixels(double mixed, double dropped) {
  test::PanelScene scene = test::wall(2.0);
  scene.add_panel({0.503, 0, 1}, {1, 4});
  scene.sensor().depth.flying_mixed = mixed;
  scene.sensor().depth.flying_dropped = dropped;
  EdgePixels found;
  SensorModel model(scene.cell, scene.sensor().camera);
  const auto depth = test::expose(model, scene.state).depth_mm;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (model.truth().mixed_m[i] == 0) {
      EXPECT_NEAR(depth[i], 1000 * model.truth().depth_m[i], 0.5001);
      continue;
    }
    (depth[i] == 0 ? found.dropped : depth[i] > 1001 && depth[i] < 1999 ? found.between : found.clean) += 1;
  }
  return found;
}

TEST(DepthModel, FlyingPixelsLieOnEdgesAlone) {
  const EdgePixels none = edge_pixels(0, 0);
  EXPECT_EQ(none.between + none.dropped, 0);
  EXPECT_GT(none.clean, 200);
  const EdgePixels some = edge_pixels(0.4, 0.4);
  EXPECT_GT(some.between, 50);
  EXPECT_GT(some.dropped, 50);
  EXPECT_GT(some.clean, 20);
}

TEST(DepthModel, SameSeedSameFrame) {
  test::PanelScene scene = test::wall(1.5);
  scene.sensor().depth = DepthErrors::kinect2();
  scene.sensor().infrared = InfraredErrors::kinect2();
  SensorModel first(scene.cell, scene.sensor().camera), second(scene.cell, scene.sensor().camera);
  const auto a = test::expose(first, scene.state, 7), b = test::expose(second, scene.state, 7);
  EXPECT_EQ(a.depth_mm, b.depth_mm);
  EXPECT_EQ(a.infrared, b.infrared);
  EXPECT_NE(a.depth_mm, test::expose(first, scene.state, 8).depth_mm);
}

}  // namespace
}  // namespace calibrd::sim
