#pragma once

#include <gtest/gtest.h>

#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <locale>
#include <string>

#include "tests/support/temporary_folder.h"

namespace spinaltap::test {

/// German numbers ("1.234,5"), made with localedef, which knows the locale's source on Debian with the package locales.
class GermanLocale {
 public:
  static constexpr const char* kName = "de_DE.UTF-8";

  GermanLocale() {
    const std::string file = (folder_.path() / kName).string();
    // It warns, with exit code 1, where the source is not wholly sound.
    (void)std::system(("localedef -i de_DE -f UTF-8 '" + file + "' >/dev/null 2>&1").c_str());
    is_there_ = std::filesystem::exists(file + "/LC_NUMERIC");
  }

  bool is_there() const { return is_there_; }
  /// For $LOCPATH, in which the C library looks for locales.
  std::string path() const { return folder_.path().string(); }

 private:
  TemporaryFolder folder_;
  bool is_there_ = false;
};

/// Makes this process one whose host has taken the German locale, for C and for C++, until it goes.
class GermanHost {
 public:
  explicit GermanHost(const GermanLocale& german) {
    ::setenv("LOCPATH", german.path().c_str(), 1);
    is_german_ = std::setlocale(LC_ALL, GermanLocale::kName) != nullptr;
    if (is_german_) std::locale::global(std::locale(GermanLocale::kName));
  }
  ~GermanHost() {
    std::locale::global(std::locale::classic());
    std::setlocale(LC_ALL, "C");
    ::unsetenv("LOCPATH");
  }
  GermanHost(const GermanHost&) = delete;
  GermanHost& operator=(const GermanHost&) = delete;

  bool is_german() const { return is_german_; }

 private:
  bool is_german_ = false;
};

}  // namespace spinaltap::test

/// Skips the test where no German locale can be made.
#define SPINALTAP_NEED_GERMAN(german) \
  if (!(german).is_there()) GTEST_SKIP() << "localedef makes no de_DE.UTF-8 here: install the package locales"
