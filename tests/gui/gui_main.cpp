#include <gmock/gmock.h>

#include <QApplication>

#include "apps/planner/scene/scene_view.h"

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  spinaltap::SceneView::prepare_application();
  const QApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
