// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/json/json_text.hpp"

#include <algorithm>
#include <array>
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <charconv>
#include <cmath>

namespace calibrd::api {
namespace {

namespace json = boost::json;

bool is_scalar(const json::value& value) { return !value.is_array() && !value.is_object(); }

class Writer {
 public:
  explicit Writer(bool on_one_line) : on_one_line_(on_one_line) {}
  std::string take() { return std::move(text_); }

  void write(const json::value& value) {
    if (const auto* object = value.if_object())
      write_object(*object);
    else if (const auto* array = value.if_array())
      write_array(*array);
    else if (const auto* number = value.if_double())
      write_number(*number);
    else
      text_ += json::serialize(value);
  }

 private:
  void write_object(const json::object& object) {
    if (object.empty()) {
      text_ += "{}";
      return;
    }
    open('{');
    bool first = true;
    for (const auto& member : object) {
      next(first);
      text_ += json::serialize(json::string(member.key()));
      text_ += ": ";
      write(member.value());
    }
    close('}');
  }

  void write_array(const json::array& array) {
    if (std::all_of(array.begin(), array.end(), is_scalar)) {
      text_ += '[';
      for (std::size_t i = 0; i < array.size(); ++i) {
        if (i != 0) text_ += ", ";
        write(array[i]);
      }
      text_ += ']';
      return;
    }
    open('[');
    bool first = true;
    for (const auto& element : array) {
      next(first);
      write(element);
    }
    close(']');
  }

  void write_number(double number) {
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr;
    text_.append(std::isfinite(number) ? std::string(buffer.data(), end) : "null");
  }

  void open(char bracket) {
    text_ += bracket;
    indent_ += 2;
  }
  void next(bool& first) {
    if (!first) text_ += on_one_line_ ? ", " : ",";
    first = false;
    begin_line();
  }
  void close(char bracket) {
    indent_ -= 2;
    begin_line();
    text_ += bracket;
  }
  void begin_line() {
    if (on_one_line_) return;
    text_ += '\n';
    text_.append(indent_, ' ');
  }

  const bool on_one_line_;
  std::string text_;
  std::size_t indent_ = 0;
};

}  // namespace

std::string json_text(const json::value& value) {
  Writer writer(false);
  writer.write(value);
  return writer.take() + "\n";
}

std::string json_line(const json::value& value) {
  Writer writer(true);
  writer.write(value);
  return writer.take();
}

}  // namespace calibrd::api
