// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/infrared_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/drivers/sim/panel_scene.hpp"

namespace calibrd::sim {
namespace {

std::uint16_t brightness(test::PanelScene scene, int x = 255, int y = 205) {
  SensorModel model(scene.cell, scene.sensor().camera);
  return test::expose(model, scene.state).infrared[scene.at(x, y)];
}

TEST(InfraredModel, FallsWithTheSquareOfTheDistance) {
  EXPECT_NEAR(brightness(test::wall(1.0)), 20000, 5);
  EXPECT_NEAR(brightness(test::wall(2.0)), 5000, 3);
}

TEST(InfraredModel, FallsWithTheCosineOfTheIncidence) {
  EXPECT_NEAR(brightness(test::wall(1.0, 1.0)), 20000 * std::cos(1.0), 20);
}

TEST(InfraredModel, IsProportionalToTheAlbedo) {
  test::PanelScene grey;
  grey.add_panel({0, 0, 1}, {10, 10}, 0, 0.25F);
  EXPECT_NEAR(brightness(grey), 5000, 3);
}

TEST(InfraredModel, Saturates) {
  test::PanelScene scene = test::wall(0.4);
  scene.sensor().infrared.saturation = 40000;
  EXPECT_EQ(brightness(scene), 40000);
}

TEST(InfraredModel, NothingIsDark) { EXPECT_EQ(brightness(test::PanelScene()), 0); }

TEST(InfraredModel, NoiseIsShotAndReadNoise) {
  test::PanelScene scene = test::wall(1.0);
  scene.sensor().infrared.noise = 1;
  SensorModel model(scene.cell, scene.sensor().camera);
  double n = 0, sum = 0, squares = 0;
  for (std::uint64_t f = 0; f < 20; ++f) {
    const auto image = test::expose(model, scene.state, f).infrared;
    for (int y = 195; y < 215; ++y)
      for (int x = 245; x < 265; ++x) {
        const double error = image[scene.at(x, y)] - 20000.0 * model.truth().echo[scene.at(x, y)];
        n += 1;
        sum += error;
        squares += error * error;
      }
  }
  EXPECT_NEAR(std::sqrt(squares / n), std::sqrt(20000 + 400), 5);
  EXPECT_NEAR(sum / n, 0, 8);
}

TEST(InfraredModel, MottlingSticksToTheBody) {
  test::PanelScene scene;
  scene.add_panel({0, 0, 1}, {1, 1});
  scene.cell.objects[0].surface.texture = 0.5F;
  scene.sensor().infrared.texture = 1;
  SensorModel model(scene.cell, scene.sensor().camera);
  const auto here = test::expose(model, scene.state).infrared;
  // Ten pixels at 1 m; brightness itself changes little over so few.
  scene.state.objects[0].T_base_object.rows[3] = 10 / scene.sensor().camera.fx;
  const auto there = test::expose(model, scene.state).infrared;
  double differs = 0;
  for (int x = 200; x < 300; ++x) {
    EXPECT_NEAR(there[scene.at(x + 10, 205)], here[scene.at(x, 205)], 0.06 * here[scene.at(x, 205)]);
    differs = std::max(differs, std::abs(there[scene.at(x, 205)] - 1.0 * here[scene.at(x, 205)]));
  }
  EXPECT_GT(differs, 1500);
}

}  // namespace
}  // namespace calibrd::sim
