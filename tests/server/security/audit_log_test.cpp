// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/audit_log.hpp"

#include <gtest/gtest.h>

#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <fstream>

#include "tests/server/security/folder.hpp"

namespace calibrd {
namespace {

const api::AuditRecord kStart{
    "hmi", "192.0.2.1", "r-1", "POST", "/api/v1/sensors/k/calibrations", 202, "/api/v1/calibrations/1"};

std::vector<boost::json::object> lines_of(const std::filesystem::path& file) {
  std::vector<boost::json::object> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) lines.push_back(boost::json::parse(line).as_object());
  return lines;
}

class Audit : public ::testing::Test {
 protected:
  void write(AuditSettings settings, int times) {
    AuditLog log(std::move(settings), [this](const std::string& why) { failures_.push_back(why); });
    for (int i = 0; i < times; ++i) log.write(kStart);
  }

  const Folder folder_;
  const std::filesystem::path file_ = folder_.path / "audit.jsonl";
  std::vector<std::string> failures_;
};

TEST_F(Audit, EachLineSaysWhoWhatWhenAndWhatBecameOfIt) {
  write({file_}, 1);
  const auto lines = lines_of(file_);
  ASSERT_EQ(lines.size(), 1U);
  const auto& line = lines[0];
  EXPECT_EQ(line.at("who"), "hmi");
  EXPECT_EQ(line.at("from"), "192.0.2.1");
  EXPECT_EQ(line.at("what"), "POST /api/v1/sensors/k/calibrations");
  EXPECT_EQ(line.at("result"), "done");
  EXPECT_EQ(line.at("made"), "/api/v1/calibrations/1");
  EXPECT_EQ(line.at("time").as_string().size(), 24U);
}

TEST_F(Audit, WhatAClientNamedCannotBreakALine) {
  auto record = kStart;
  record.path = "/a\"\n{\"who\":\"nobody\"}";
  record.status = 404;
  const auto line = audit_line(record);
  EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1);
  EXPECT_EQ(boost::json::parse(line).as_object().at("result"), "refused");
}

TEST_F(Audit, GoesOnWhereItWas) {
  write({file_}, 2);
  write({file_}, 1);
  EXPECT_EQ(lines_of(file_).size(), 3U);
}

TEST_F(Audit, RotatesBySizeAndKeepsSoManyFiles) {
  AuditSettings settings{file_};
  settings.max_bytes = 3 * audit_line(kStart).size();
  settings.files = 3;
  write(settings, 20);
  EXPECT_TRUE(failures_.empty());
  EXPECT_EQ(lines_of(file_).size(), 2U);
  EXPECT_EQ(lines_of(folder_.path / "audit.1.jsonl").size(), 3U);
  EXPECT_EQ(lines_of(folder_.path / "audit.2.jsonl").size(), 3U);
  EXPECT_FALSE(std::filesystem::exists(folder_.path / "audit.3.jsonl"));
}

TEST_F(Audit, ALineThatCannotBeWrittenIsToldInFull) {
  write({folder_.path / "none/audit.jsonl"}, 1);
  ASSERT_EQ(failures_.size(), 1U);
  EXPECT_NE(failures_[0].find("POST /api/v1/sensors/k/calibrations"), std::string::npos);
  EXPECT_NE(failures_[0].find("none/audit.jsonl"), std::string::npos);
}

TEST_F(Audit, AFullDiskIsToldAndTheNextLineIsWhole) {
  std::filesystem::create_symlink("/dev/full", file_);
  write({file_}, 2);
  EXPECT_EQ(failures_.size(), 2U);
}

TEST_F(Audit, WhatNoRequestChangedIsALineToo) {
  {
    AuditLog log({file_}, [this](const std::string& why) { failures_.push_back(why); });
    log.note({"calibrd", "pose of kinect2", true, "/api/v1/calibrations/1", {}});
    log.note({"SIGHUP", "configuration", false, {}, "line 3"});
  }
  const auto lines = lines_of(file_);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].at("who"), "calibrd");
  EXPECT_EQ(lines[0].at("made"), "/api/v1/calibrations/1");
  EXPECT_FALSE(lines[0].contains("detail"));
  EXPECT_EQ(lines[1].at("result"), "refused");
  EXPECT_EQ(lines[1].at("detail"), "line 3");
  EXPECT_TRUE(failures_.empty());
}

}  // namespace
}  // namespace calibrd
