// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/load_config.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "server/config/config_error.hpp"

namespace calibrd {
namespace {

constexpr const char* kSmallest = R"([robot]
urdf = "robot.urdf"
host = "10.0.0.5"
)";

class LoadConfig : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("calibrd_config_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Result<LoadedConfig> load(const std::string& toml, std::vector<std::string> environment = {},
                            std::vector<std::string> overrides = {}) {
    std::ofstream(folder_ / "cell.toml") << toml;
    return load_config({folder_ / "cell.toml", std::move(environment), std::move(overrides)});
  }

  std::string failure(const std::string& toml, std::vector<std::string> overrides = {}) {
    const auto loaded = load(toml, {}, std::move(overrides));
    return loaded ? "" : loaded.error().message();
  }

  std::filesystem::path folder_;
};

TEST_F(LoadConfig, TakesDefaultsForWhatTheFileLeavesOut) {
  const auto loaded = load(kSmallest);
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(loaded->config.server.port, 8080);
  EXPECT_EQ(loaded->config.server.address, "127.0.0.1");
  EXPECT_EQ(loaded->config.robot.port, 50241);
}

TEST_F(LoadConfig, PortAndJointsThatNobodySetAreThoseOfTheDriver) {
  const auto rtde = std::string(kSmallest) + "driver = \"ur_rtde\"\n";
  const auto loaded = load(rtde);
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(loaded->config.robot.port, 30004);
  EXPECT_EQ(loaded->config.robot.joint_count, 6);
  const auto chosen = load(rtde, {"CALIBRD_ROBOT__PORT=31004"}, {"robot.joint_count=5"});
  ASSERT_TRUE(chosen) << chosen.error().message();
  EXPECT_EQ(chosen->config.robot.port, 31004);
  EXPECT_EQ(chosen->config.robot.joint_count, 5);
}

TEST_F(LoadConfig, AnUnknownDriverIsRefusedWithTheNearestName) {
  const auto text = failure(std::string(kSmallest) + "driver = \"ur_rtd\"\n");
  EXPECT_NE(text.find("did you mean 'ur_rtde'"), std::string::npos) << text;
}

TEST_F(LoadConfig, PathsAreRelativeToTheFile) {
  const auto loaded = load(kSmallest);
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->config.robot.urdf, folder_ / "robot.urdf");
}

TEST_F(LoadConfig, EnvironmentBeatsFileAndCommandLineBeatsBoth) {
  const auto file =
      std::string(kSmallest) + "[server]\nport = 1001\nmax_connections = 7\n[log]\nlevel = \"warn\"\n";
  const auto loaded = load(file, {"CALIBRD_SERVER__PORT=1002", "CALIBRD_LOG__LEVEL=debug", "HOME=/root"},
                           {"server.port=1003"});
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(loaded->config.server.port, 1003);
  EXPECT_EQ(loaded->config.log.level, "debug");
  EXPECT_EQ(loaded->config.server.max_connections, 7);
  EXPECT_EQ(loaded->origins.at("server.port"), "--set server.port");
  EXPECT_EQ(loaded->origins.at("log.level"), "CALIBRD_LOG__LEVEL");
  EXPECT_EQ(loaded->origins.at("server.max_connections"), "cell.toml:6");
}

TEST_F(LoadConfig, EnvironmentFindsASensorWhoseNameHasADashOrCapitals) {
  const auto file =
      std::string(kSmallest) + "[sensors.Kinect-2]\nfx = 365.0\nfy = 365.0\ncx = 255.0\ncy = 211.0\n";
  const auto loaded = load(file, {"CALIBRD_SENSORS__KINECT_2__FX=366.5"});
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(loaded->config.sensors.size(), 1U);
  EXPECT_DOUBLE_EQ(loaded->config.sensors.at("Kinect-2").camera.fx, 366.5);
}

TEST_F(LoadConfig, UnknownKeyIsRefusedWithLineAndNearestName) {
  const auto text = failure(std::string(kSmallest) + "[server]\nprot = 1\n");
  EXPECT_NE(text.find("cell.toml:5"), std::string::npos) << text;
  EXPECT_NE(text.find("did you mean 'port'"), std::string::npos) << text;
}

TEST_F(LoadConfig, AKeyOfTheCommandLineIsNamedOnce) {
  const auto value = failure(kSmallest, {"server.port=abc"});
  EXPECT_TRUE(value.starts_with("--set server.port: abc is not an integer")) << value;
  const auto key = failure(kSmallest, {"server.prot=1"});
  EXPECT_TRUE(key.starts_with("--set server.prot (did you mean 'port'")) << key;
}

TEST_F(LoadConfig, UnknownSectionIsRefusedWithNearestName) {
  const auto text = failure(std::string(kSmallest) + "[sensor.kinect2]\nfx = 1\n");
  EXPECT_NE(text.find("did you mean 'sensors'"), std::string::npos) << text;
}

TEST_F(LoadConfig, UnknownSensorKeyIsRefusedWithNearestName) {
  const auto text = failure(std::string(kSmallest) + "[sensors.kinect2]\nwidht = 1\n");
  EXPECT_NE(text.find("did you mean 'width'"), std::string::npos) << text;
}

TEST_F(LoadConfig, ValueOutOfRangeIsRefusedWithLine) {
  const auto text = failure(std::string(kSmallest) + "[server]\n\nport = 70000\n");
  EXPECT_NE(text.find("cell.toml:6: server.port: 70000 is not an integer, 0 to 65535"), std::string::npos)
      << text;
}

TEST_F(LoadConfig, ValueOfWrongTypeIsRefused) {
  EXPECT_NE(failure(std::string(kSmallest) + "[server]\nport = \"x\"\n").find("server.port"),
            std::string::npos);
  EXPECT_NE(failure(std::string(kSmallest) + "[pose]\nmax_unverified = 60\n").find("give it a unit"),
            std::string::npos);
  EXPECT_NE(failure(std::string(kSmallest) + "[log]\nformat = \"jsn\"\n").find("did you mean 'json'"),
            std::string::npos);
  EXPECT_NE(failure(std::string(kSmallest) + "[server]\nport = 2024-01-01\n").find("server.port"),
            std::string::npos);
}

TEST_F(LoadConfig, SectionWhereAValueBelongsIsRefused) {
  EXPECT_NE(failure(std::string(kSmallest) + "[server.port]\nx = 1\n"), "");
  EXPECT_NE(failure("robot = 1\n").find("is a section"), std::string::npos);
}

TEST_F(LoadConfig, BrokenTomlNamesTheLine) {
  EXPECT_NE(failure("[robot]\nurdf = \n").find("cell.toml:2"), std::string::npos)
      << failure("[robot]\nurdf = \n");
}

TEST_F(LoadConfig, CharactersBeyondAsciiBelongInCommentsAndQuotes) {
  const std::string good =
      "# Stra\xc3\x9f"
      "e\n" +
      std::string(kSmallest) + "[storage]\npath = \"/daten/\xc3\xa9\" # \xe2\x82\xac\n";
  EXPECT_EQ(failure(good), "");
  for (const char* bad :
       {"\xc3\xa9 = 1\n", "[server.\xce\x95]\n", "x = 1 \xc3\xa9\n", "x = \"\"\" \\\n \xc3\xa9\"\"\"\n"})
    EXPECT_NE(failure(std::string(kSmallest) + bad).find("beyond ASCII"), std::string::npos) << bad;
  EXPECT_NE(failure("a = 'x'\n\xc3\xa9 = 1\n").find("cell.toml:2"), std::string::npos);
}

TEST_F(LoadConfig, VariablesAndOptionsThatAreNotUtf8AreRefused) {
  EXPECT_FALSE(load(kSmallest, {"CALIBRD_ROBOT__HOST=\xff"}));
  EXPECT_FALSE(load(kSmallest, {}, {"robot.host=\xc3"}));
  EXPECT_TRUE(load(kSmallest, {"OTHER=\xff", "CALIBRD_ROBOT__HOST=\xc3\xa9"}));
}

TEST_F(LoadConfig, EmptyFileIsAFileWithoutKeys) {
  EXPECT_NE(failure("").find("robot.urdf"), std::string::npos) << failure("");
}

TEST_F(LoadConfig, SectionWithoutKeysIsASectionAllTheSame) {
  EXPECT_EQ(failure(std::string(kSmallest) + "[server]\n[log]\n"), "");
  EXPECT_NE(failure(std::string(kSmallest) + "[sevrer]\n").find("did you mean 'server'"), std::string::npos);
  EXPECT_NE(failure(std::string(kSmallest) + "[sensors.a]\n").find("sensors.a.fx"), std::string::npos);
  EXPECT_NE(failure(std::string(kSmallest) + "[server.port]\n"), "");
}

TEST_F(LoadConfig, MissingNeededKeyIsNamed) {
  EXPECT_NE(failure("[robot]\nhost = \"h\"\n").find("robot.urdf"), std::string::npos);
  EXPECT_NE(failure(std::string(kSmallest) + "[sensors.a]\nfx = 1\n").find("sensors.a.fy"),
            std::string::npos);
}

TEST_F(LoadConfig, AbsentFileIsNamed) {
  const auto loaded = load_config({folder_ / "none.toml", {}, {}});
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ConfigError::file_unreadable);
  EXPECT_NE(loaded.error().message().find("none.toml"), std::string::npos);
}

TEST_F(LoadConfig, OverrideWithoutValueIsRefused) {
  const auto loaded = load(kSmallest, {}, {"server.port"});
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ConfigError::bad_override);
}

TEST_F(LoadConfig, ReadsJointsCouplingGuessAndWorkspace) {
  const auto loaded = load(std::string(kSmallest) + R"(
[robot.joints.joint_3]
axis = 2
sign = -1
offset_deg = 90
coupling = { joint_2 = 1.0 }
[sensors.k]
fx = 1
fy = 1
cx = 1
cy = 1
guess = [[1, 0, 0, 0.5], [0, 1, 0, 0.25], [0, 0, 1, 2], [0, 0, 0, 1]]
workspace = { tray = [0.4, -0.2, 0.1] }
)");
  ASSERT_TRUE(loaded) << loaded.error().message();
  const auto& joint = loaded->config.robot.joints.at("joint_3");
  EXPECT_EQ(joint.axis, 2);
  EXPECT_EQ(joint.sign, -1);
  EXPECT_DOUBLE_EQ(joint.coupling.at("joint_2"), 1.0);
  ASSERT_TRUE(loaded->config.sensors.at("k").guess_T_base_sensor);
  EXPECT_DOUBLE_EQ(loaded->config.sensors.at("k").guess_T_base_sensor->translation().y(), 0.25);
  EXPECT_DOUBLE_EQ(loaded->config.sensors.at("k").workspace.at("tray")[1], -0.2);
}

TEST_F(LoadConfig, WorkspacePointNeedsThreeNumbers) {
  const auto text = failure(std::string(kSmallest) +
                            "[sensors.k]\nfx = 1\nfy = 1\ncx = 1\ncy = 1\nworkspace = { tray = [1, 2] }\n");
  EXPECT_NE(text.find("sensors.k.workspace.tray"), std::string::npos) << text;
}

TEST_F(LoadConfig, GuessInMillimetresIsRefused) {
  const auto text = failure(std::string(kSmallest) + "[sensors.k]\nguess = [1370, 730, 860, 0, 0, 0, 1]\n");
  EXPECT_NE(text.find("metres"), std::string::npos) << text;
}

TEST_F(LoadConfig, RecordingAndDeviceExcludeEachOther) {
  const auto text = failure(std::string(kSmallest) +
                            "[sensors.k]\nfx = 1\nfy = 1\ncx = 1\ncy = 1\nuri = \"a\"\noni_file = \"b\"\n");
  EXPECT_NE(text.find("exclude each other"), std::string::npos) << text;
}

TEST_F(LoadConfig, ConfigurationsOfTheRepositoryAreGood) {
  for (const auto* name : {"calibrd.toml", "demo.toml"}) {
    const auto loaded = load_config({std::filesystem::path(CALIBRD_SOURCE_DIR "/config") / name, {}, {}});
    EXPECT_TRUE(loaded) << loaded.error().message();
  }
}

TEST_F(LoadConfig, SensorIdMustFitAUrl) {
  EXPECT_NE(failure(std::string(kSmallest) + "[sensors.\"a/b\"]\nfx = 1\nfy = 1\ncx = 1\ncy = 1\n")
                .find("an id has"),
            std::string::npos);
}

TEST_F(LoadConfig, MotionIsOffSlowAndCannotBeMadeFast) {
  const auto loaded = load(kSmallest);
  ASSERT_TRUE(loaded);
  EXPECT_FALSE(loaded->config.motion.enabled);
  EXPECT_EQ(loaded->config.motion.max_speed_deg_s, 5);
  for (const char* line : {"max_speed_deg_s = 20.1", "max_speed_deg_s = 0", "max_acceleration_deg_s2 = 61",
                           "path_tolerance_deg = 6", "port = 0"})
    EXPECT_NE(failure(std::string(kSmallest) + "[motion]\n" + line + "\n").find("cell.toml:5: motion."),
              std::string::npos)
        << line;
}

TEST_F(LoadConfig, RoutesAreListsOfPostures) {
  const auto routes = std::string(kSmallest) + "[motion.routes.tour]\n";
  const auto loaded = load(routes + "postures_deg = [[0, 20.5], [10, -25]]\n");
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(loaded->config.motion.routes.at("tour").postures_deg,
            (std::vector<std::vector<double>>{{0, 20.5}, {10, -25}}));
  for (const char* value : {"[]", "[[]]", "[0, 20]", "[[0, \"a\"]]", "[[0, 1000]]", "7"})
    EXPECT_NE(failure(routes + "postures_deg = " + value + "\n").find("motion.routes.tour.postures_deg"),
              std::string::npos)
        << value;
  EXPECT_NE(failure(routes).find("motion.routes.tour.postures_deg"), std::string::npos)
      << "a route without postures";
}

}  // namespace
}  // namespace calibrd
