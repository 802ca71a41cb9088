// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/api/pose_formats/read_pose.hpp"

#include <functional>
#include <map>
#include <numbers>
#include <regex>
#include <stdexcept>
#include <vector>

namespace calibrd::test {
namespace {

namespace json = boost::json;
using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Numbers = std::vector<double>;

Matrix3d about_x(double rad) { return AngleAxisd(rad, Vector3d::UnitX()).toRotationMatrix(); }
Matrix3d about_y(double rad) { return AngleAxisd(rad, Vector3d::UnitY()).toRotationMatrix(); }
Matrix3d about_z(double rad) { return AngleAxisd(rad, Vector3d::UnitZ()).toRotationMatrix(); }
double rad(double deg) { return deg * std::numbers::pi / 180; }

/// The matrix of a unit quaternion, written out: neither Eigen's order nor its normalization takes part.
Matrix3d of_quaternion(double x, double y, double z, double w) {
  Matrix3d R;
  R << 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),  //
      2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),   //
      2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y);
  return R;
}

Matrix3d of_vector(double x, double y, double z) {
  const Vector3d v(x, y, z);
  return v.norm() > 0 ? AngleAxisd(v.norm(), v.normalized()).toRotationMatrix() : Matrix3d::Identity();
}

Isometry3d pose(const Matrix3d& R, double x, double y, double z) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() = R;
  T.translation() = Vector3d(x, y, z);
  return T;
}

Isometry3d pose_mm(const Matrix3d& R, double x, double y, double z) {
  return pose(R, x / 1e3, y / 1e3, z / 1e3);
}

/// What each format means, of its numbers in the order of its documentation.
const std::map<std::string, std::function<Isometry3d(const Numbers&)>> kMeaning{
    {"matrix",
     [](const Numbers& n) {
       Isometry3d T;
       for (int i = 0; i < 16; ++i) T.matrix()(i / 4, i % 4) = n.at(static_cast<std::size_t>(i));
       return T;
     }},
    {"quaternion",
     [](const Numbers& n) { return pose(of_quaternion(n[3], n[4], n[5], n.at(6)), n[0], n[1], n[2]); }},
    {"rotvec", [](const Numbers& n) { return pose(of_vector(n[3], n[4], n.at(5)), n[0], n[1], n[2]); }},
    {"rpy",
     [](const Numbers& n) {
       return pose(about_z(n.at(5)) * about_y(n[4]) * about_x(n[3]), n[0], n[1], n[2]);
     }},
    {"kuka",
     [](const Numbers& n) {
       return pose_mm(about_z(rad(n[3])) * about_y(rad(n[4])) * about_x(rad(n.at(5))), n[0], n[1], n[2]);
     }},
    {"xyz_fixed",  // FANUC, Yaskawa, Mitsubishi: the first angle is about x
     [](const Numbers& n) {
       return pose_mm(about_z(rad(n.at(5))) * about_y(rad(n[4])) * about_x(rad(n[3])), n[0], n[1], n[2]);
     }},
    {"kawasaki",
     [](const Numbers& n) {
       return pose_mm(about_z(rad(n[3])) * about_y(rad(n[4])) * about_z(rad(n.at(5))), n[0], n[1], n[2]);
     }},
    {"abb",
     [](const Numbers& n) { return pose_mm(of_quaternion(n[4], n[5], n.at(6), n[3]), n[0], n[1], n[2]); }},
    {"halcon",
     [](const Numbers& n) {
       if (n.at(6) != 0) throw std::invalid_argument("type of the HALCON pose");
       return pose(about_x(rad(n[3])) * about_y(rad(n[4])) * about_z(rad(n[5])), n[0], n[1], n[2]);
     }},
    {"opencv", [](const Numbers& n) { return pose(of_vector(n[0], n[1], n[2]), n[3], n[4], n.at(5)); }},
};

/// A format's name in kMeaning, and its members in the order of its documentation.
struct Members {
  const char* meaning;
  std::vector<const char*> names;
};

const std::map<std::string, Members> kMembers{
    {"matrix", {"matrix", {"T_base_sensor"}}},
    {"quaternion", {"quaternion", {"translation_m", "rotation_xyzw"}}},
    {"rotvec", {"rotvec", {"translation_m", "rotation_vector_rad"}}},
    {"ros2", {"quaternion", {"translation_m", "rotation_xyzw"}}},
    {"ros1", {"quaternion", {"translation_m", "rotation_xyzw"}}},
    {"ros2 rpy", {"rpy", {"translation_m", "roll_pitch_yaw_rad"}}},
    {"urdf", {"rpy", {"xyz_m", "rpy_rad"}}},
    {"kuka", {"kuka", {"X_mm", "Y_mm", "Z_mm", "A_deg", "B_deg", "C_deg"}}},
    {"fanuc", {"xyz_fixed", {"X_mm", "Y_mm", "Z_mm", "W_deg", "P_deg", "R_deg"}}},
    {"yaskawa", {"xyz_fixed", {"X_mm", "Y_mm", "Z_mm", "Rx_deg", "Ry_deg", "Rz_deg"}}},
    {"mitsubishi", {"xyz_fixed", {"X_mm", "Y_mm", "Z_mm", "A_deg", "B_deg", "C_deg"}}},
    {"kawasaki", {"kawasaki", {"X_mm", "Y_mm", "Z_mm", "O_deg", "A_deg", "T_deg"}}},
    {"abb", {"abb", {"trans_mm", "rot_wxyz"}}},
    {"ur", {"rotvec", {"pose"}}},
    {"halcon", {"halcon", {"pose"}}},
    {"opencv", {"opencv", {"rvec_rad", "tvec_m"}}},
};

void add_numbers(const json::value& value, Numbers& numbers) {
  if (value.is_array())
    for (const auto& item : value.as_array()) add_numbers(item, numbers);
  else
    numbers.push_back(value.to_number<double>());
}

/// The numbers of a command line, by the names of its options.
Numbers option_values(const std::string& text) {
  Numbers values;
  for (const auto* option : {"--x ", "--y ", "--z ", "--qx ", "--qy ", "--qz ", "--qw "})
    values.push_back(std::stod(text.substr(text.find(option) + std::string(option).size())));
  return values;
}

}  // namespace

Numbers numbers_in(const std::string& text) {
  static const std::regex kNumber(R"((^|[^\w.])(-?\d+\.?\d*)(?![\w.]))");
  Numbers numbers;
  for (std::sregex_iterator match(text.begin(), text.end(), kNumber), end; match != end; ++match)
    numbers.push_back(std::stod((*match)[2]));
  return numbers;
}

Isometry3d read_members(const std::string& format, const json::object& payload) {
  const auto& [meaning, names] = kMembers.at(format);
  Numbers numbers;
  for (const auto* name : names) add_numbers(payload.at(name), numbers);
  return kMeaning.at(meaning)(numbers);
}

Isometry3d read_text(const std::string& format, const json::object& payload) {
  const std::string text(payload.at("text").as_string());
  if (format == "ros2") return kMeaning.at("quaternion")(option_values(text));
  auto numbers = numbers_in(text);
  if (format == "halcon") numbers.push_back(0);  // the texts behind the numbers say the type
  return kMeaning.at(kMembers.at(format).meaning)(numbers);
}

}  // namespace calibrd::test
