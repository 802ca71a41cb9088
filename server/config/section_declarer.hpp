// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "server/config/kinds.hpp"
#include "server/config/setting.hpp"

namespace calibrd {

/// The part of the configuration that a path's names pick; made when it is not there yet.
template <class Section>
using Pick = std::function<Section&(Config&, const Names&)>;

template <class Section>
class SectionDeclarer {
 public:
  SectionDeclarer(std::vector<Setting>& table, std::vector<std::string> path, Pick<Section> pick)
      : table_(table), path_(std::move(path)), pick_(std::move(pick)) {}

  template <class Member, class T>
  Setting& operator()(const char* key, Member member, Kind<T> kind, const char* unit, const char* meaning) {
    Setting setting;
    setting.path = path_;
    setting.path.emplace_back(key);
    setting.type = kind.name;
    setting.unit = unit;
    setting.meaning = meaning;
    setting.set = [pick = pick_, member, read = kind.read](Config& config, const Names& names,
                                                           const RawValue& raw) -> Status {
      auto value = read(raw);
      if (!value) return value.error();
      std::invoke(member, pick(config, names)) = *std::move(value);
      return Done{};
    };
    setting.toml = [pick = pick_, member, write = kind.write](const Config& config, const Names& names) {
      Config copy = config;  // pick() may make the section
      return write(std::invoke(member, pick(copy, names)));
    };
    table_.push_back(std::move(setting));
    return table_.back();
  }

 private:
  std::vector<Setting>& table_;
  std::vector<std::string> path_;
  Pick<Section> pick_;
};

// Parts of the table in files of their own.
void declare_drift(std::vector<Setting>& table);
void declare_motion(std::vector<Setting>& table);
void declare_server(std::vector<Setting>& table);
void declare_audit(std::vector<Setting>& table);
void declare_mqtt(std::vector<Setting>& table);

}  // namespace calibrd
