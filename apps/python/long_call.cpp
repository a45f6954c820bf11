#include "apps/python/long_call.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace py = pybind11;

namespace spinaltap {

namespace {

struct Report {
  std::string stage;
  double fraction = 0.0;
};

/// What the work's threads tell the one that waits.
struct Mailbox {
  std::mutex mutex;
  std::condition_variable wakes;
  std::vector<Report> reports;
  bool is_done = false;
  std::exception_ptr error;

  void add(std::string_view stage, double fraction) {
    const std::lock_guard lock(mutex);
    reports.push_back({std::string(stage), fraction});
    wakes.notify_one();
  }
  void end(std::exception_ptr its_error) {
    const std::lock_guard lock(mutex);
    error = std::move(its_error);
    is_done = true;
    wakes.notify_one();
  }
  /// Waits for news, but not for long: signals are to be looked for.
  bool wait(std::vector<Report>& news) {
    constexpr std::chrono::milliseconds kPatience{50};
    std::unique_lock lock(mutex);
    wakes.wait_for(lock, kPatience, [this] { return is_done || !reports.empty(); });
    news.clear();
    news.swap(reports);
    return is_done;
  }
};

void hand_over(const py::object& tell, const std::vector<Report>& news) {
  for (const Report& report : news) tell(report.stage, report.fraction);
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace

void run_long(const py::object& tell, const std::function<void(const Progress&)>& work) {
  Mailbox mailbox;
  const bool tells = !tell.is_none();
  const Progress progress([&](std::string_view stage, double fraction) {
    if (tells) mailbox.add(stage, fraction);
  });
  std::exception_ptr raised;
  std::vector<Report> news;
  {
    const std::jthread worker([&] {
      try {
        work(progress);
        mailbox.end(nullptr);
      } catch (...) {
        mailbox.end(std::current_exception());
      }
    });
    for (bool is_done = false; !is_done;) {
      {
        const py::gil_scoped_release unlocked;
        is_done = mailbox.wait(news);
      }
      if (raised) continue;
      try {
        hand_over(tell, news);
      } catch (...) {
        raised = std::current_exception();
        progress.cancel();
      }
    }
  }
  if (raised) std::rethrow_exception(raised);
  if (mailbox.error) std::rethrow_exception(mailbox.error);
}

}  // namespace spinaltap
