#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>
#include <tbb/global_control.h>

#include <cstddef>
#include <map>
#include <memory>
#include <string>

#include "apps/python/bindings.h"
#include "core/base/error.h"
#include "core/base/version.h"
#include "core/files/data_files.h"

namespace py = pybind11;

namespace spinaltap {

namespace {

/// How many threads TBB may use; 0: one a core.
void set_threads(int threads) {
  static std::unique_ptr<tbb::global_control> limit;
  if (threads < 0) fail("expected a number of threads, or 0 for one a core; found ", threads);
  limit.reset();
  if (threads > 0) {
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(threads));
  }
}

/// Whoever waits for work that Ctrl-C cancels raises KeyboardInterrupt itself: see run_long(). Cancelled is for the
/// rest.
void bind_errors(py::module_& module) {
  static const py::handle error = py::exception<Error>(module, "Error", PyExc_RuntimeError).release();
  error.attr("__doc__") = "What was expected, what was found and where, in one line that a person can act on.";
  error.attr("kind") = "";
  // A class for each kind, which is also what Python people expect of it.
  static std::map<ErrorKind, py::handle> kinds;
  const auto add = [&module](ErrorKind kind, const char* name, PyObject* known_as, const char* doc) {
    const py::tuple bases = known_as != nullptr ? py::make_tuple(error, py::handle(known_as)) : py::make_tuple(error);
    const std::string full = std::string("spinaltap._core.") + name;
    const py::handle made = PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr);
    if (!made) throw py::error_already_set();
    made.attr("kind") = std::string(name_of(kind));
    module.attr(name) = made;
    kinds[kind] = made;
  };
  add(ErrorKind::input, "InputError", PyExc_ValueError, "A value, an option or a file's content is not as expected.");
  add(ErrorKind::geometry, "GeometryError", PyExc_ValueError, "A place, a path or a tool does not fit the bone.");
  add(ErrorKind::file, "FileError", PyExc_FileNotFoundError, "A file or folder is missing, or cannot be opened.");
  add(ErrorKind::disk, "DiskError", PyExc_OSError, "Something cannot be written.");
  add(ErrorKind::unsupported, "UnsupportedError", PyExc_NotImplementedError, "Understood, but not handled.");
  add(ErrorKind::internal, "InternalError", nullptr, "A mistake in this library.");
  // pybind11 asks for it by value. NOLINTNEXTLINE(performance-unnecessary-value-param)
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Cancelled& cancelled) {
      PyErr_SetString(PyExc_KeyboardInterrupt, cancelled.what());
    } catch (const Error& mistake) {
      const auto found = kinds.find(mistake.kind());
      PyErr_SetString((found == kinds.end() ? error : found->second).ptr(), mistake.what());
    }
  });
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.doc() = "SpinalTap's C++, for the package spinaltap: use that.";
  module.attr("__version__") = version();
  bind_errors(module);
  bind_plan(module);
  bind_view(module);
  bind_bone(module);
  bind_registration(module);
  bind_record(module);
  bind_session(module);
  bind_study(module);
  bind_drill_task(module);
  module.def("set_threads", &set_threads, py::arg("threads"),
             "How many threads everything may use; 0, as at first: one a core. Results do not depend on it.");
  module.def("set_data_folder", &set_data_folder, py::arg("folder"),
             "Where the shipped files (anatomy, cutting models, sizes) are; an empty path takes it back.");
  module.def(
      "_add_data_folder", [](const std::filesystem::path& folder) { add_data_folder(folder); }, py::arg("folder"));
}

}  // namespace spinaltap
