// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/surroundings.hpp"

#include <OniCAPI.h>
#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

namespace calibrd {
namespace {

namespace fs = std::filesystem;

std::string joined(std::vector<std::string> items) {
  std::sort(items.begin(), items.end());
  std::string text;
  for (const auto& item : items) text += (text.empty() ? "" : ", ") + item;
  return text.empty() ? "none" : text;
}

/// Where OpenNI2 looks for drivers unless its ini says otherwise: beside the library, as the loader names it.
fs::path driver_directory() {
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&oniInitialize), &info) == 0 || info.dli_fname == nullptr)
    return {};
  return fs::path(info.dli_fname).parent_path() / "OpenNI2" / "Drivers";
}

std::vector<std::string> drivers_in(const fs::path& directory) {
  std::vector<std::string> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(directory, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("lib") && name.ends_with(".so.0")) found.push_back(name);
  }
  return found;
}

std::string first_word(const fs::path& file) {
  std::string word;
  std::ifstream(file) >> word;
  return word;
}

bool is_permitted(const fs::path& device) {
  char node[64];
  std::snprintf(node, sizeof(node), "/dev/bus/usb/%03d/%03d",
                std::atoi(first_word(device / "busnum").c_str()),
                std::atoi(first_word(device / "devnum").c_str()));
  return ::access(node, R_OK | W_OK) == 0;
}

std::vector<std::string> usb_devices() {
  std::vector<std::string> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/sys/bus/usb/devices", ignored)) {
    const std::string vendor = first_word(entry.path() / "idVendor");
    const bool is_hub = first_word(entry.path() / "bDeviceClass") == "09";
    if (vendor.empty() || is_hub) continue;
    std::string text = vendor + ":" + first_word(entry.path() / "idProduct");
    if (!is_permitted(entry.path())) text += " (no permission to open it)";
    found.push_back(std::move(text));
  }
  return found;
}

}  // namespace

std::string describe_surroundings() {
  const fs::path directory = driver_directory();
  return "drivers tried in " + directory.string() + ": " + joined(drivers_in(directory)) +
         "; USB devices: " + joined(usb_devices());
}

}  // namespace calibrd
