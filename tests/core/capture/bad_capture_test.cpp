// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/core/capture/recording.hpp"
#include "tests/core/capture/test_png.hpp"

namespace calibrd {
namespace {

using namespace test;
namespace fs = std::filesystem;

/// The reading failed with `code`, and the message names what is at fault and says what to do.
void expect_error(const Result<Capture>& capture, CaptureError code, const std::string& named) {
  ASSERT_FALSE(capture) << "was read without an error";
  EXPECT_EQ(capture.error().code, make_error_code(code)) << capture.error().message();
  EXPECT_NE(capture.error().detail.find(named), std::string::npos) << capture.error().message();
  EXPECT_NE(capture.error().code.message().find(';'), std::string::npos) << "says what is wrong; what to do";
}

struct BadDocument {
  const char* name;
  const char* from;
  const char* to;
  CaptureError code;
  const char* named;
};

void PrintTo(const BadDocument& bad, std::ostream* out) { *out << bad.from << " -> " << bad.to; }

class BadCapture : public testing::TestWithParam<BadDocument> {};

TEST_P(BadCapture, IsRefusedByName) {
  const BadDocument& bad = GetParam();
  Recording recording;
  recording.change(bad.from, bad.to);
  expect_error(recording.read(), bad.code, bad.named);
}

using enum CaptureError;
INSTANTIATE_TEST_SUITE_P(
    Document, BadCapture,
    testing::Values(
        BadDocument{"NotJson", "{\"format\"", "{format", bad_json, "line 1, column 2"},
        BadDocument{"CutOff", "\"stamp_s\": 2.5}]}", "\"stamp_s\"", bad_json, "line 4"},
        BadDocument{"MoreBehindIt", "2.5}]}", "2.5}]} {}", bad_json, "line 4"},
        BadDocument{"WrongFormat", "capture/1", "capture/2", wrong_format, "capture/2"},
        BadDocument{"NoFormat", "\"format\": \"capture/1\", ", "", missing_key, "format"},
        BadDocument{"FormatIsANumber", "\"capture/1\"", "1", bad_value, "format (1;"},
        BadDocument{"NoteIsANumber", "\"by hand\"", "3", bad_value, "note"},
        BadDocument{"NoRobot", "\"robot\"", "\"robto\"", missing_key, "robot"},
        BadDocument{"NoSensor", "\"sensor\"", "\"Sensor\"", missing_key, "sensor"},
        BadDocument{"SensorIsAList", "{\"id\": \"s\", \"width\": 8,", "[1], \"x\": {\"a\": 1,", bad_value,
                    "sensor"},
        BadDocument{"NoFrames", "\"frames\"", "\"Frames\"", missing_key, "frames"},
        BadDocument{"EmptyFrames", "\"frames\": [{", "\"frames\": [], \"x\": [{", no_frames, "frames"},
        BadDocument{"FrameIsANumber", "\"frames\": [{", "\"frames\": [7, {", bad_value, "frames[0]"},
        BadDocument{"NoDepth", "\"depth\":", "\"dept\":", missing_key, "frames[0].depth"},
        BadDocument{"NoUrdfKey", "\"urdf\"", "\"udrf\"", missing_key, "robot.urdf"},
        BadDocument{"UrdfNotThere", "robot.urdf", "other.urdf", urdf_not_found, "other.urdf"},
        BadDocument{"UrdfEmpty", "robot.urdf", "", urdf_not_found, "robot.urdf"},
        BadDocument{"BaseLinkIsANumber", "\"base\"", "0", bad_value, "robot.base_link"},
        BadDocument{"NoJointNames", "\"joint_names\"", "\"names\"", missing_key, "robot.joint_names"},
        BadDocument{"JointNameIsANumber", "[\"a\", \"b\"]", "[\"a\", 2]", bad_value, "robot.joint_names"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Sensor, BadCapture,
    testing::Values(BadDocument{"NoWidth", "\"width\": 8, ", "", missing_key, "sensor.width"},
                    BadDocument{"WidthIsText", "\"width\": 8", "\"width\": \"8\"", bad_value, "sensor.width"},
                    BadDocument{"HalfAPixel", "\"width\": 8", "\"width\": 8.5", bad_value, "sensor.width"},
                    BadDocument{"NegativeWidth", "\"width\": 8", "\"width\": -8", bad_value, "sensor.width"},
                    BadDocument{"HugeWidth", "\"width\": 8", "\"width\": 1e12", bad_value, "sensor.width"},
                    BadDocument{"TooWide", "\"width\": 8", "\"width\": 8193", bad_value, "sensor.width"},
                    BadDocument{"ZeroHeight", "\"height\": 8", "\"height\": 0", bad_value, "sensor.height"},
                    BadDocument{"ZeroFx", "\"fx\": 10", "\"fx\": 0", bad_value, "sensor.fx"},
                    BadDocument{"NegativeFy", "\"fy\": 11.5", "\"fy\": -11.5", bad_value, "sensor.fy"},
                    BadDocument{"InfiniteFx", "\"fx\": 10", "\"fx\": 1e999", bad_value, "sensor.fx"},
                    BadDocument{"NoCx", "\"cx\": 3.5, ", "", missing_key, "sensor.cx"},
                    BadDocument{"CxFarOutside", "\"cx\": 3.5", "\"cx\": 3500", bad_value, "sensor.cx"},
                    BadDocument{"CyIsNull", "\"cy\": 4", "\"cy\": null", bad_value, "sensor.cy"},
                    BadDocument{"DepthScaleZero", "0.001", "0", bad_value, "sensor.depth_scale_m"},
                    BadDocument{"DepthScaleNegative", "0.001", "-0.001", bad_value, "sensor.depth_scale_m"},
                    BadDocument{"DepthScalePerMetre", "0.001", "1000", bad_value, "sensor.depth_scale_m"},
                    BadDocument{"DepthScaleTiny", "0.001", "1e-300", bad_value, "sensor.depth_scale_m"},
                    BadDocument{"DepthScaleMissing", ", \"depth_scale_m\": 0.001", "", missing_key,
                                "sensor.depth_scale_m"},
                    BadDocument{"FourCoefficients", "\"cy\": 4", "\"cy\": 4, \"distortion\": [0, 0, 0, 0]",
                                bad_value, "4 numbers"},
                    BadDocument{"CoefficientIsText", "\"cy\": 4",
                                "\"cy\": 4, \"distortion\": [0, 0, 0, 0, \"0\"]", bad_value,
                                "sensor.distortion"},
                    BadDocument{"InfiniteCoefficient", "\"cy\": 4",
                                "\"cy\": 4, \"distortion\": [1e999, 0, 0, 0, 0]", bad_value,
                                "sensor.distortion"},
                    BadDocument{"FoldingDistortion", "\"cy\": 4",
                                "\"cy\": 4, \"distortion\": [-20, 0, 0, 0, 0]", bad_value, "folds"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Joints, BadCapture,
    testing::Values(
        BadDocument{"OneMissing", "[0.5, -1]", "[0.5]", wrong_joint_count, "1 values for 2"},
        BadDocument{"OneTooMany", "[0.5, -1]", "[0.5, -1, 0]", wrong_joint_count, "3 values for 2"},
        BadDocument{"None", "[0.5, -1]", "[]", wrong_joint_count, "frames[0].joint_positions_rad"},
        BadDocument{"KeyMissing", "\"joint_positions_rad\": [0.5, -1], ", "", missing_key,
                    "frames[0].joint_positions_rad"},
        BadDocument{"NaN", "[0.5, -1]", "[NaN, -1]", bad_json, "line 4"},
        BadDocument{"Infinity", "[0.5, -1]", "[Infinity, -1]", bad_json, "line 4"},
        BadDocument{"TooLargeForADouble", "[0.5, -1]", "[0.5, 1e999]", bad_value,
                    "frames[0].joint_positions_rad"},
        BadDocument{"Null", "[0.5, -1]", "[0.5, null]", bad_value, "frames[0].joint_positions_rad"},
        BadDocument{"Text", "[0.5, -1]", "[\"0.5\", -1]", bad_value, "\"0.5\""},
        BadDocument{"StampIsText", "2.5", "\"now\"", bad_value, "frames[0].stamp_s"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Images, BadCapture,
    testing::Values(
        BadDocument{"DepthNotThere", "depth.png", "depth_7.png", unreadable, "depth_7.png"},
        BadDocument{"ImageNotThere", "image.png", "image_7.png", unreadable, "image_7.png"},
        BadDocument{"ImageIsNull", "\"image.png\"", "null", bad_value, "frames[0].image"},
        BadDocument{"DepthIsTheFolder", "depth.png", ".", unreadable, "not a file"},
        BadDocument{"DepthIsNoPng", "depth.png", "robot.urdf", bad_png, "robot.urdf"},
        BadDocument{"DepthNameEmpty", "depth.png", "", path_outside, "frames[0].depth"},
        BadDocument{"DepthAbove", "depth.png", "../../etc/passwd", path_outside, "../../etc/passwd"},
        BadDocument{"DepthAboveInside", "depth.png", "a/../../depth.png", path_outside, "frames[0].depth"},
        BadDocument{"DepthAbsolute", "depth.png", "/etc/passwd", path_outside, "/etc/passwd"},
        BadDocument{"ImageAbsolute", "image.png", "/dev/zero", path_outside, "frames[0].image"},
        BadDocument{"DepthNameHoldsNul", "depth.png", "depth.png\\u0000.txt", path_outside,
                    "frames[0].depth"}),
    [](const auto& test) { return test.param.name; });

TEST(BadCaptureFolder, MissingFolderIsNamed) {
  const ScratchFolder folder;
  expect_error(read_capture(folder.path() / "nowhere", {}), no_such_folder, "nowhere");
}

TEST(BadCaptureFolder, FileInPlaceOfTheFolderIsNamed) {
  const Recording recording;
  expect_error(read_capture(recording.path("capture.json"), {}), no_such_folder, "capture.json");
}

TEST(BadCaptureFolder, FolderWithoutDocumentNamesTheDocument) {
  const ScratchFolder folder;
  expect_error(read_capture(folder.path(), {}), unreadable, "capture.json");
}

TEST(BadCaptureFolder, FolderInPlaceOfTheDocumentIsNoCrash) {
  const ScratchFolder folder;
  fs::create_directory(folder.path() / "capture.json");
  expect_error(read_capture(folder.path(), {}), unreadable, "not a file");
}

TEST(BadCaptureFolder, EmptyDocumentIsBadJson) {
  const ScratchFolder folder;
  folder.write("capture.json", "");
  expect_error(read_capture(folder.path(), {}), bad_json, "line 1, column 1");
}

TEST(BadCaptureFolder, ListInPlaceOfTheDocumentIsBadJson) {
  const ScratchFolder folder;
  folder.write("capture.json", "[1, 2]");
  expect_error(read_capture(folder.path(), {}), bad_json, "not an object");
}

TEST(BadCaptureFolder, MillionNestedListsAreRefusedWithoutOverflow) {
  const ScratchFolder folder;
  folder.write("capture.json", "{\"format\": " + std::string(1000000, '['));
  expect_error(read_capture(folder.path(), {}), bad_json, "line 1");
}

TEST(BadCaptureFolder, DocumentOfAbsurdSizeIsRefusedUnread) {
  const Recording recording;
  fs::resize_file(recording.path("capture.json"), std::uintmax_t{1} << 40U);  // sparse
  expect_error(recording.read(), file_too_large, "capture.json");
}

TEST(BadCaptureFolder, PipeInPlaceOfAnImageDoesNotHang) {
  const Recording recording;
  fs::remove(recording.path("depth.png"));
  ASSERT_EQ(mkfifo(recording.path("depth.png").c_str(), 0600), 0);
  expect_error(recording.read(), unreadable, "not a file");
}

TEST(BadCaptureFolder, FolderInPlaceOfAnImageIsNoCrash) {
  const Recording recording;
  fs::remove(recording.path("image.png"));
  fs::create_directory(recording.path("image.png"));
  expect_error(recording.read(), unreadable, "image.png");
}

TEST(BadCaptureFolder, FolderInPlaceOfTheUrdfIsNotFound) {
  const Recording recording;
  fs::remove(recording.path("robot.urdf"));
  fs::create_directory(recording.path("robot.urdf"));
  expect_error(recording.read(), urdf_not_found, "robot.urdf");
}

TEST(BadCaptureFolder, EndlessListOfFramesIsRefusedBeforeItFillsMemory) {
  Recording recording;
  recording.change("\"width\": 8, \"height\": 8", "\"width\": 8192, \"height\": 8192");
  std::string frames;
  for (int i = 0; i < 20; ++i) frames += "{}, ";
  recording.change("\"frames\": [", "\"frames\": [" + frames);
  expect_error(recording.read(), bad_value, "frames (21;");
}

// ---- images of the wrong kind

TEST(BadCaptureImage, DepthOfTheWrongSizeNamesBothSizes) {
  const Recording recording;
  recording.put_image("depth.png", 1000, 8, 9);
  expect_error(recording.read(), wrong_image_size, "8x9, expected 8x8");
}

TEST(BadCaptureImage, ImageOfTheWrongSizeNamesBothSizes) {
  const Recording recording;
  recording.put_image("image.png", 20, 16, 16);
  expect_error(recording.read(), wrong_image_size, "image.png (16x16, expected 8x8)");
}

TEST(BadCaptureImage, HugeImageIsRefusedUnpacked) {
  const Recording recording;  // megapixels of zeros are a small file
  recording.folder().write(
      "depth.png", png_of(4096, 4096, SPNG_COLOR_TYPE_GRAYSCALE, 8, std::vector<unsigned char>(4096 * 4096)));
  expect_error(recording.read(), wrong_image_size, "4096x4096");
}

TEST(BadCaptureImage, EightBitDepthIsRefused) {
  const Recording recording;
  recording.folder().write("depth.png",
                           png_of(8, 8, SPNG_COLOR_TYPE_GRAYSCALE, 8, std::vector<unsigned char>(64, 9)));
  expect_error(recording.read(), wrong_bit_depth, "frames[0].depth (8 bits, grey)");
}

TEST(BadCaptureImage, ColourDepthIsRefused) {
  const Recording recording;
  recording.folder().write(
      "depth.png", png_of(8, 8, SPNG_COLOR_TYPE_TRUECOLOR, 16, std::vector<unsigned char>(6 * 64, 9)));
  expect_error(recording.read(), wrong_bit_depth, "frames[0].depth (16 bits, colour)");
}

TEST(BadCaptureImage, TruncatedDepthIsRefusedAtEveryLength) {
  const Recording recording;
  std::ifstream file(recording.path("depth.png"), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t last_checksum = 4;  // of the end chunk, which says nothing
  for (std::size_t length = 0; length < whole.size() - last_checksum; ++length) {
    recording.folder().write("depth.png", whole.substr(0, length));
    const auto capture = recording.read();
    ASSERT_FALSE(capture) << "was read with " << length << " of " << whole.size() << " bytes";
    EXPECT_EQ(capture.error().code, make_error_code(bad_png)) << length;
  }
}

TEST(BadCaptureImage, FlippedBitsAreRefusedOrHarmless) {
  const Recording recording;
  std::ifstream file(recording.path("depth.png"), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const auto expected = recording.read()->views[0].depth.raw;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string broken = whole;
    broken[i] = static_cast<char>(broken[i] ^ 0x10);
    recording.folder().write("depth.png", broken);
    const auto capture = recording.read();
    if (!capture) continue;
    EXPECT_EQ(capture->views[0].depth.raw, expected) << "byte " << i;
  }
}

}  // namespace
}  // namespace calibrd
