// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/collada_nodes.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "core/robot/xml_tags.hpp"

namespace calibrd {
namespace {

constexpr int kMaxDepth = 128;
constexpr int kMaxNodes = 10'000;

struct Node {
  std::vector<std::size_t> children;
  std::vector<std::string_view> instances;  // what it calls for, by name
};

class Nodes {
 public:
  /// False: a name holds an entity, so nobody but an XML parser knows what it is.
  bool read(std::string_view collada) {
    std::vector<std::size_t> open;
    for (XmlTag tag; next_tag(collada, tag);) {
      if (tag.name == "instance_node" && tag.opens && !open.empty()) {
        const auto url = attribute(tag, "url");
        if (url.find('&') != std::string_view::npos) return false;
        nodes_[open.back()].instances.push_back(url.substr(url.starts_with('#') ? 1 : 0));
      }
      if (tag.name != "node") continue;
      if (tag.opens && !add(tag, open)) return false;
      if (tag.closes && !open.empty()) open.pop_back();
    }
    return true;
  }

  bool come_to_an_end() {
    return std::ranges::all_of(roots_, [this](std::size_t root) { return follow(root, 1); });
  }

 private:
  bool add(const XmlTag& tag, std::vector<std::size_t>& open) {
    const std::size_t node = nodes_.size();
    nodes_.emplace_back();
    (open.empty() ? roots_ : nodes_[open.back()].children).push_back(node);
    open.push_back(node);
    for (const auto* const key : {"id", "sid", "name"}) {  // assimp looks for any of them
      const auto name = attribute(tag, key);
      if (name.find('&') != std::string_view::npos) return false;
      if (!name.empty()) named_.emplace(name, node);
    }
    return true;
  }

  bool follow(std::size_t node, int depth) {
    if (depth > kMaxDepth || ++followed_ > kMaxNodes) return false;
    const auto deeper = [&](std::size_t next) { return follow(next, depth + 1); };
    if (!std::ranges::all_of(nodes_[node].children, deeper)) return false;
    for (const auto& name : nodes_[node].instances) {
      const auto [first, last] = named_.equal_range(name);
      if (!std::all_of(first, last, [&](const auto& entry) { return deeper(entry.second); })) return false;
    }
    return true;
  }

  std::vector<Node> nodes_;
  std::vector<std::size_t> roots_;
  std::multimap<std::string_view, std::size_t> named_;
  int followed_ = 0;
};

}  // namespace

bool nodes_come_to_an_end(std::string_view collada) {
  Nodes nodes;
  return nodes.read(collada) && nodes.come_to_an_end();
}

}  // namespace calibrd
