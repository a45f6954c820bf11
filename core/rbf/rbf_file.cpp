// The format is described in docs/rbf-file.md. Its checksum is zlib's CRC-32 and not our own WordHash64, so that a
// reader in any language finds it in its library.

#include "core/rbf/rbf_file.h"

#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <span>
#include <string>

#include "core/base/error.h"
#include "core/base/file_stream.h"
#include "core/base/hash.h"
#include "core/base/staged_output.h"

namespace spinaltap {
namespace {

constexpr std::array<char, 8> kMagic{'S', 'T', 'A', 'P', 'R', 'B', 'F', '\n'};
constexpr std::uint32_t kVersion = 2;

static_assert(std::endian::native == std::endian::little, "the file is little endian");
static_assert(sizeof(Vec3) == 3 * sizeof(double), "centres are written as they stand in memory");

struct Head {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t power = 0;  ///< of r in the kernel
  double low_pass_mm = 0.0;
  std::array<double, 3> origin_mm{};
  std::uint64_t centres = 0;
  std::uint64_t polynomial = 0;
};
static_assert(sizeof(Head) == 64);

std::string_view bytes_of(std::span<const double> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

/// The head, once it is known that the file is as long as it says.
Head read_head(std::string_view bytes, const std::string& name) {
  Head head;
  if (!bytes.starts_with(std::string_view(kMagic.data(), kMagic.size()))) {
    fail("expected a radial basis function written by spinaltap fit, found another kind of file: ", name);
  }
  if (bytes.size() < sizeof head) fail("expected a head of ", sizeof head, " bytes, found it cut short: ", name);
  std::memcpy(&head, bytes.data(), sizeof head);
  if (head.version != kVersion) {
    fail(name, ": this is a version ", head.version, " radial basis function; version ", kVersion,
         " is expected: fit again");
  }
  if (head.power != 1 && head.power != 3) fail("expected kernel 1 or 3, found ", head.power, " in ", name);
  const RadialKernel kernel = head.power == 1 ? RadialKernel::biharmonic : RadialKernel::triharmonic;
  if (head.polynomial != polynomial_terms(kernel)) {
    fail("expected ", polynomial_terms(kernel), " polynomial coefficients, found ", head.polynomial, " in ", name);
  }
  constexpr std::uint64_t kCentreBytes = 4 * sizeof(double);
  const std::uint64_t around = sizeof head + head.polynomial * sizeof(double) + sizeof(std::uint32_t);
  if (bytes.size() < around || (bytes.size() - around) % kCentreBytes != 0 ||
      (bytes.size() - around) / kCentreBytes != head.centres) {
    fail("expected a file of ", head.centres, " centres, found ", bytes.size(), " bytes (cut short?) in ", name);
  }
  return head;
}

}  // namespace

void write_rbf(const RbfModel& model, const std::filesystem::path& path) {
  check_model(model);
  Head head;
  head.power = static_cast<std::uint32_t>(power_of(model.kernel));
  head.low_pass_mm = model.low_pass_mm;
  head.origin_mm = {model.origin_mm.x(), model.origin_mm.y(), model.origin_mm.z()};
  head.centres = model.centres_mm.size();
  head.polynomial = model.polynomial.size();
  const double* const centres = model.centres_mm.empty() ? nullptr : model.centres_mm.front().data();
  FileWriter file(path);
  std::uint32_t crc = 0;
  for (const std::string_view bytes :
       {std::string_view(reinterpret_cast<const char*>(&head), sizeof head), bytes_of(model.polynomial),
        bytes_of({centres, 3 * model.centres_mm.size()}), bytes_of(model.weights)}) {
    crc = crc32_of(bytes, crc);
    file.write(bytes);
  }
  file.write({reinterpret_cast<const char*>(&crc), sizeof crc});
  file.close();
}

RbfModel read_rbf(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string bytes = read_whole_file(path, std::numeric_limits<std::size_t>::max());
  const Head head = read_head(bytes, name);
  std::uint32_t crc = 0;
  std::memcpy(&crc, bytes.data() + bytes.size() - sizeof crc, sizeof crc);
  if (crc != crc32_of(std::string_view(bytes).substr(0, bytes.size() - sizeof crc))) {
    fail("expected a whole file, found a damaged one (its checksum differs): ", name);
  }
  RbfModel model;
  model.kernel = head.power == 1 ? RadialKernel::biharmonic : RadialKernel::triharmonic;
  model.low_pass_mm = head.low_pass_mm;
  model.origin_mm = Vec3(head.origin_mm[0], head.origin_mm[1], head.origin_mm[2]);
  model.polynomial.resize(head.polynomial);
  model.centres_mm.resize(head.centres);
  model.weights.resize(head.centres);
  const char* next = bytes.data() + sizeof head;
  const auto take = [&next](void* to, std::size_t count) {
    if (count > 0) std::memcpy(to, next, count);
    next += count;
  };
  take(model.polynomial.data(), model.polynomial.size() * sizeof(double));
  take(model.centres_mm.data(), model.centres_mm.size() * sizeof(Vec3));
  take(model.weights.data(), model.weights.size() * sizeof(double));
  try {
    check_model(model);
  } catch (const Error& error) {
    fail(error.what(), " in ", name);
  }
  return model;
}

}  // namespace spinaltap
