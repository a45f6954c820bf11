#include "core/ct/detail/dicom_library.h"

#include <gdcmTrace.h>

namespace spinaltap {

void silence_gdcm() {
  static const bool silent = [] {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
    return true;
  }();
  static_cast<void>(silent);
}

}  // namespace spinaltap
