// Gives each reader damaged files for a while: valid ones of every kind, changed at random. Reading them must give what
// they hold or an Error of one line, in time, and without more memory than the file explains. Build it with sanitizers.
//
//   fuzz_readers [--reader NAME|all] [--seconds N] [--seed N] [--case N] [--jobs N] [--keep FOLDER]
//
// --case repeats one case of a reader and leaves its files in FOLDER: what to add to tests/fuzz/found when it is
// mended.

#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <map>
#include <optional>
#include <thread>

#include "core/base/error.h"
#include "tests/fuzz/readers.h"

#if defined(SPINALTAP_ADDRESS_SANITIZER)
#include <sanitizer/lsan_interface.h>
// GCC's runtime has it, and no header for it.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*, std::size_t),
                                                         void (*on_free)(const volatile void*));
// What was freed is kept from use for a while: not so much that it hides what readers take.
extern "C" const char* __asan_default_options() { return "max_allocation_size_mb=1000:quarantine_size_mb=32"; }
// What it loses of a damaged file is not ours to free; of other libraries, see tests/leaks.supp.
extern "C" const char* __lsan_default_suppressions() { return "leak:libnifti2\n"; }
#endif

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr unsigned kHangSeconds = 60;
constexpr long kMaxMegabytes = 1024;

struct Arguments {
  std::vector<const Reader*> readers;
  double seconds = 60.0;
  std::uint64_t seed = 0;
  std::optional<std::uint64_t> only_case;
  std::size_t jobs = 1;
  bool is_alone = false;  ///< one reader, in this process
  fs::path keep = "found";
};

std::uint64_t whole_number(const std::string& text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) fail("expected a whole number, found ", text);
  return number;
}

Arguments arguments_of(int argc, char** argv) {
  Arguments arguments;
  arguments.seed = std::random_device()();
  arguments.jobs = std::max(1U, std::thread::hardware_concurrency());
  std::string name = "all";
  for (int n = 1; n + 1 < argc; n += 2) {
    const std::string option = argv[n];
    const std::string value = argv[n + 1];
    if (option == "--reader" || option == "--alone") {
      name = value;
      arguments.is_alone = option == "--alone";
    } else if (option == "--seconds") {
      arguments.seconds = std::strtod(value.c_str(), nullptr);
    } else if (option == "--seed") {
      arguments.seed = whole_number(value);
    } else if (option == "--case") {
      arguments.only_case = whole_number(value);
    } else if (option == "--jobs") {
      arguments.jobs = whole_number(value);
    } else if (option == "--keep") {
      arguments.keep = value;
    } else {
      fail("no such option: ", option);
    }
  }
  if (argc % 2 == 0) fail("expected a value after ", argv[argc - 1]);
  if (name == "all") {
    for (const Reader& reader : all_readers()) arguments.readers.push_back(&reader);
  } else {
    arguments.readers.push_back(&reader_called(name));
  }
  if (arguments.only_case && arguments.readers.size() != 1) fail("expected a --reader with --case");
  return arguments;
}

#if defined(SPINALTAP_ADDRESS_SANITIZER)
std::atomic<std::size_t> max_allocation{0};

void look_at_allocation(const volatile void*, std::size_t bytes) {
  if (bytes <= max_allocation) return;
  std::fprintf(stderr, "asked for %zu MB at once\n", bytes >> 20);
  std::abort();
}
#endif

long max_megabytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

/// Where the files of the case that is read stand; they stay behind when the process is stopped.
fs::path case_folder(const Reader& reader, pid_t process) {
  return fs::temp_directory_path() / ("spinaltap-fuzz-" + std::to_string(process)) / reader.name;
}

class ReaderRun {
 public:
  ReaderRun(const Reader& reader, std::uint64_t seed)
      : reader_(reader), seed_(seed), folder_(case_folder(reader, ::getpid())), seeds_(reader.seeds()) {
    fs::create_directories(folder_);
  }

  /// Returns whether the reader stood it.
  bool run(std::uint64_t number) {
    write_quickly(folder_.parent_path() / "number", std::to_string(number));
    std::seed_seq mixed{seed_ & 0xffffffffU, seed_ >> 32, number & 0xffffffffU, number >> 32};
    std::mt19937_64 random(mixed);
    const Seed& seed = seeds_[random() % seeds_.size()];
    for (const auto& entry : fs::directory_iterator(folder_)) fs::remove_all(entry);
    for (const Case& file : unchanged(seed)) write_quickly(folder_ / file.name, file.bytes);
    const Case changed = changed_case(seed, seeds_, random);
    write_quickly(folder_ / changed.name, changed.bytes);
    ::alarm(kHangSeconds);
    const Outcome outcome = outcome_of(reader_, folder_);
    ::alarm(0);
    ++(outcome.is_read ? read_ : rejected_);
    message_ = outcome.message;
    std::string finding = outcome.finding;
    if (max_megabytes() > kMaxMegabytes) finding = "took " + std::to_string(max_megabytes()) + " MB";
    if (finding.empty()) return true;
    std::printf("%s, made from %s: %s\n", reader_.name.c_str(), seed.name.c_str(), finding.c_str());
    return false;
  }

  const std::string& message() const { return message_; }
  const fs::path& folder() const { return folder_; }
  void print(double seconds) const {
    const double a_minute = 60.0 * static_cast<double>(read_ + rejected_) / seconds;
    std::printf("%-18s %9llu cases %9.0f a minute %8llu read %9llu rejected %6ld MB %7.0f s\n", reader_.name.c_str(),
                read_ + rejected_, a_minute, read_, rejected_, max_megabytes(), seconds);
  }

 private:
  const Reader& reader_;
  std::uint64_t seed_;
  fs::path folder_;
  std::vector<Seed> seeds_;
  unsigned long long read_ = 0, rejected_ = 0;
  std::string message_;
};

int fuzz(const Reader& reader, const Arguments& arguments) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  ReaderRun run(reader, arguments.seed);
#if defined(SPINALTAP_ADDRESS_SANITIZER)
  if (reader.loses_memory) __lsan_disable();
  max_allocation = reader.max_allocation;
  __sanitizer_install_malloc_and_free_hooks(look_at_allocation, [](const volatile void*) {});
#endif
  const Clock::time_point begin = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  for (std::uint64_t number = 0; seconds() < arguments.seconds; ++number) {
    if (!run.run(number)) return EXIT_FAILURE;
  }
  run.print(seconds());
  fs::remove_all(run.folder().parent_path());
  return EXIT_SUCCESS;
}

int repeat(const Reader& reader, const Arguments& arguments) {
  ReaderRun run(reader, arguments.seed);
  const bool stood = run.run(*arguments.only_case);
  fs::create_directories(arguments.keep);
  fs::copy(run.folder(), arguments.keep, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  std::printf("%s: %s; its files are in %s\n", reader.name.c_str(), stood ? "stood it" : "did not stand it",
              arguments.keep.c_str());
  if (!run.message().empty()) std::printf("it says: %s\n", run.message().c_str());
  return stood ? EXIT_SUCCESS : EXIT_FAILURE;
}

void print_finding(const Reader& reader, pid_t process, int status, const Arguments& arguments) {
  const fs::path folder = case_folder(reader, process);
  std::string number = "?";
  if (std::FILE* file = std::fopen((folder.parent_path() / "number").c_str(), "r")) {
    char text[32] = {};
    if (std::fgets(text, sizeof text, file) != nullptr) number = text;
    std::fclose(file);
  }
  const std::string how = WIFSIGNALED(status) ? ::strsignal(WTERMSIG(status)) : "see above";
  std::printf("FOUND: %s (%s); its files are in %s; repeat: fuzz_readers --reader %s --seed %llu --case %s\n",
              reader.name.c_str(), how.c_str(), folder.c_str(), reader.name.c_str(),
              static_cast<unsigned long long>(arguments.seed), number.c_str());
}

/// The reader in a process of its own, from its beginning: threads of the libraries' do not outlive a fork.
pid_t start(const Reader& reader, const Arguments& arguments) {
  const std::string seconds = std::to_string(arguments.seconds);
  const std::string seed = std::to_string(arguments.seed);
  const pid_t process = ::fork();
  if (process < 0) fail("cannot start a process: ", std::strerror(errno));
  if (process == 0) {
    ::execl("/proc/self/exe", "fuzz_readers", "--alone", reader.name.c_str(), "--seconds", seconds.c_str(), "--seed",
            seed.c_str(), nullptr);
    ::_exit(EXIT_FAILURE);
  }
  return process;
}

int fuzz_all(const Arguments& arguments) {
  std::printf("seed %llu, %zu readers, %.0f s each\n", static_cast<unsigned long long>(arguments.seed),
              arguments.readers.size(), arguments.seconds);
  std::map<pid_t, const Reader*> running;
  std::size_t found = 0;
  const auto wait_for_one = [&] {
    int status = 0;
    const pid_t process = ::wait(&status);
    if (process < 0) fail("cannot wait for a reader: ", std::strerror(errno));
    if (status != 0) {
      ++found;
      print_finding(*running.at(process), process, status, arguments);
    }
    running.erase(process);
  };
  for (const Reader* reader : arguments.readers) {
    if (running.size() >= arguments.jobs) wait_for_one();
    std::fflush(stdout);
    running.emplace(start(*reader, arguments), reader);
  }
  while (!running.empty()) wait_for_one();
  std::printf("%zu readers, %zu broken\n", arguments.readers.size(), found);
  return found == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int run(int argc, char** argv) {
  const Arguments arguments = arguments_of(argc, argv);
  if (arguments.only_case) return repeat(*arguments.readers.front(), arguments);
  return arguments.is_alone ? fuzz(*arguments.readers.front(), arguments) : fuzz_all(arguments);
}

}  // namespace
}  // namespace spinaltap::test

int main(int argc, char** argv) {
  try {
    return spinaltap::test::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz_readers: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
