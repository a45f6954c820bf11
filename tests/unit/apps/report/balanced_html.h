#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <string>
#include <vector>

namespace spinaltap::test {

/// Every opened element is closed in order (void elements aside).
inline void expect_balanced(const std::string& html) {
  std::vector<std::string> open;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    const std::size_t end = html.find('>', at);
    ASSERT_NE(end, std::string::npos);
    const bool closes = html[at + 1] == '/';
    const std::size_t begin = at + (closes ? 2 : 1);
    if (std::isalnum(static_cast<unsigned char>(html[begin])) == 0) continue;  // <!doctype>
    std::size_t name_end = begin;
    while (std::isalnum(static_cast<unsigned char>(html[name_end])) != 0) ++name_end;
    const std::string name = html.substr(begin, name_end - begin);
    if (html[end - 1] == '/' || name == "meta" || name == "img") continue;
    if (!closes) {
      open.push_back(name);
      continue;
    }
    ASSERT_FALSE(open.empty()) << "closes " << name;
    ASSERT_EQ(open.back(), name);
    open.pop_back();
  }
  EXPECT_TRUE(open.empty());
}

/// The report without its embedded pictures, whose letters mean nothing.
inline std::string without_pictures(const std::string& html) {
  std::string rest;
  std::size_t from = 0;
  for (std::size_t at = html.find("base64,"); at != std::string::npos; at = html.find("base64,", from)) {
    rest += html.substr(from, at - from);
    from = html.find('"', at);
  }
  return rest + html.substr(from);
}

}  // namespace spinaltap::test
