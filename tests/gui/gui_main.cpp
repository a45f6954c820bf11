#include <gmock/gmock.h>

#include <QApplication>
#include <cstdlib>

#include "tests/support/temporary_folder.h"

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  // What windows keep for after a crash, caches and settings are not the user's.
  const spinaltap::test::TemporaryFolder home;
  for (const char* name : {"XDG_STATE_HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"}) {
    ::setenv(name, (home.path() / name).c_str(), 1);
  }
  const QApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
