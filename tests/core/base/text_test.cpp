// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/text.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

TEST(Utf8, TextOfEveryLengthOfSequenceIsUtf8) {
  for (const char* text :
       {"", "plain", "\xc3\xa9", "\xe2\x82\xac", "\xed\x9f\xbf", "\xf0\x9f\x98\x80", "\xf4\x8f\xbf\xbf"})
    EXPECT_TRUE(is_utf8(text)) << text;
}

TEST(Utf8, OverlongFormsSurrogatesAndWhatIsBeyondUnicodeAreNot) {
  for (const char* text : {"\xc0\xaf", "\xe0\x80\xaf", "\xf0\x80\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80",
                           "\xf5\x80\x80\x80"})
    EXPECT_FALSE(is_utf8(text)) << text;
}

TEST(Utf8, HalfACharacterIsNot) {
  for (const char* text : {"\xc3", "a\xe2\x82", "\x80", "\xc3(", "\xf0\x9f\x98"})
    EXPECT_FALSE(is_utf8(text)) << text;
}

TEST(Shortened, NeverCutsThroughACharacter) {
  const std::string euros = "\xe2\x82\xac\xe2\x82\xac\xe2\x82\xac";
  for (std::size_t bytes = 0; bytes <= euros.size(); ++bytes)
    EXPECT_TRUE(is_utf8(shortened(euros, bytes, "..."))) << bytes;
  EXPECT_EQ(shortened(euros, 5, "..."), "\xe2\x82\xac...");
  EXPECT_EQ(shortened(euros, 9, "..."), euros);
}

}  // namespace
}  // namespace calibrd
