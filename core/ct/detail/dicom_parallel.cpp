#include "core/ct/detail/dicom_parallel.h"

#include <tbb/parallel_for.h>

#include <exception>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {

void for_each_file(std::size_t count, std::string_view stage, const Progress& progress,
                   const std::function<void(std::size_t)>& work) {
  ProgressCounter counter(progress, stage, count);
  std::vector<std::exception_ptr> errors(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
    try {
      work(n);
    } catch (const Error&) {
      errors[n] = std::current_exception();
    }
    counter.add();
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace spinaltap
