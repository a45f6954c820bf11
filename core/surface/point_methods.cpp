#include "core/surface/point_methods.h"

#include "core/base/error.h"

namespace spinaltap {

const std::map<std::string, PointMethod>& point_methods() {
  static const std::map<std::string, PointMethod> methods{
      {"pixels", PointMethod::pixels}, {"normals", PointMethod::normals}, {"contours", PointMethod::contours}};
  return methods;
}

const std::string& name_of(PointMethod method) {
  for (const auto& [name, known] : point_methods()) {
    if (known == method) return name;
  }
  fail("no such method for surface points");
}

}  // namespace spinaltap
