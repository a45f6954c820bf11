#include "core/ct/nrrd_head.h"

#include "core/base/text_writer.h"

namespace spinaltap {

std::string nrrd_head(const GridGeometry& geometry, const std::string& type, const std::string& encoding) {
  TextWriter text(17);
  const auto vector = [&](const Vec3& v) { text << '(' << v.x() << ',' << v.y() << ',' << v.z() << ')'; };
  text << "NRRD0004\ntype: " << type << "\ndimension: 3\nspace: left-posterior-superior\nsizes: " << geometry.size[0]
       << ' ' << geometry.size[1] << ' ' << geometry.size[2] << "\nspace directions:";
  for (int axis = 0; axis < 3; ++axis) {
    text << ' ';
    vector(geometry.index_to_patient_matrix().col(axis));
  }
  text << "\nkinds: domain domain domain\nendian: little\nencoding: " << encoding << "\nspace origin: ";
  vector(geometry.origin_mm);
  text << '\n';
  return text.str();
}

}  // namespace spinaltap
