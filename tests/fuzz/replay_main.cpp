// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
//
// Stands in for libFuzzer where the compiler has none: gives a target every file of the folders named, then
// for one second random changes of them. An input that ends the program is printed as hex.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz.hpp"

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongest = 1U << 16U;
constexpr std::size_t kChanges = 10'000;
constexpr auto kChangingFor = std::chrono::seconds(1);

std::string current;  // what the target is being given

/// Only what a signal handler may call.
extern "C" void tell_current(int number) {
  constexpr const char* kHex = "0123456789abcdef";
  for (const char c : current) {
    const auto byte = static_cast<unsigned char>(c);
    const char pair[2] = {kHex[byte >> 4U], kHex[byte & 15U]};
    if (write(STDERR_FILENO, pair, sizeof pair) < 0) break;
  }
  std::signal(number, SIG_DFL);
  std::raise(number);
}

void give(std::string input) {
  current = std::move(input);
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(current.data()), current.size());
}

std::vector<std::string> read_files(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());  // the same order everywhere
  std::vector<std::string> files;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    files.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return files;
}

class Changer {
 public:
  explicit Changer(const std::vector<std::string>& files) : files_(files) {}

  /// One of the files with one to four changes.
  std::string next() {
    std::string input = any_file();
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(input);
    input.resize(std::min(input.size(), kLongest));
    return input;
  }

 private:
  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }
  const std::string& any_file() { return files_[below(files_.size())]; }

  void change(std::string& input) {
    const std::size_t at = below(input.size() + 1), length = std::min(1 + below(16), input.size() - at);
    const std::string& other = any_file();
    const std::size_t from = below(other.size() + 1);
    switch (below(5)) {
      case 0:
        return void(input.erase(at, length));
      case 1:
        return void(input.insert(at, input.substr(at, length)));
      case 2:
        return void(input.insert(at, other, from, 1 + below(32)));
      case 3:
        return void(input.replace(at, length, other, from, length));
      default:
        if (at < input.size())
          input[at] = static_cast<char>(below(2) ? below(256) : input[at] ^ (1 << below(8)));
    }
  }

  const std::vector<std::string>& files_;
  std::mt19937_64 random_{1};
};

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i)
    for (auto& file : read_files(argv[i])) files.push_back(std::move(file));
  if (files.empty()) {
    std::fprintf(stderr, "usage: %s CORPUS_FOLDER...\n", argv[0]);
    return 2;
  }
  for (const int number : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS, SIGILL}) std::signal(number, tell_current);
  for (const auto& file : files) give(file);
  std::size_t changed = 0;
  Changer changer(files);
  const auto end = std::chrono::steady_clock::now() + kChangingFor;
  for (; changed < kChanges && std::chrono::steady_clock::now() < end; ++changed) give(changer.next());
  std::printf("%zu files, %zu changes of them\n", files.size(), changed);
  return 0;
}
