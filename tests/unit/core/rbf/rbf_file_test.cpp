#include "core/rbf/rbf_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <limits>

#include "core/base/staged_output.h"
#include "tests/support/error_of.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Numbers that text, float or a flush of denormals would change.
RbfModel odd_model(RadialKernel kernel) {
  RbfModel model;
  model.kernel = kernel;
  model.low_pass_mm = 0.1;
  model.origin_mm = Vec3(1.0 / 3.0, -0.0, 1e300);
  model.centres_mm = {{0.1, 0.2, 0.3}, {-1e-310, 5e-324, 1e17 + 2.0}};
  model.weights = {-2.0 / 3.0, std::numeric_limits<double>::max()};
  for (std::size_t k = 0; k < polynomial_terms(kernel); ++k) model.polynomial.push_back(1.0 / (3.0 + double(k)));
  return model;
}

/// With a fresh checksum, so that what else is wrong comes to light.
std::string sealed(std::string bytes) {
  const std::size_t end = bytes.size() - 4;
  const auto crc = static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), end));
  std::memcpy(bytes.data() + end, &crc, sizeof crc);
  return bytes;
}

template <class Number>
std::string with(std::string bytes, std::size_t at, Number number) {
  std::memcpy(bytes.data() + at, &number, sizeof number);
  return sealed(std::move(bytes));
}

class RbfFile : public testing::Test {
 protected:
  std::string error_reading(const std::string& bytes) {
    write_whole_file(path_, bytes);
    const std::string error = error_of([&] { read_rbf(path_); });
    EXPECT_THAT(error, AllOf(HasSubstr("some.rbf"), Not(HasSubstr("\n"))));
    return error;
  }
  std::string bytes_of(const RbfModel& model) {
    write_rbf(model, path_);
    return read_whole_file(path_);
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "some.rbf";
};

TEST_F(RbfFile, GivesEveryBitBack) {
  for (const RadialKernel kernel : {RadialKernel::biharmonic, RadialKernel::triharmonic}) {
    const RbfModel model = odd_model(kernel);
    const std::string bytes = bytes_of(model);
    const RbfModel read = read_rbf(path_);
    EXPECT_EQ(read.kernel, kernel);
    EXPECT_EQ(read.centres_mm, model.centres_mm);
    EXPECT_EQ(read.weights, model.weights);
    EXPECT_EQ(read.polynomial, model.polynomial);
    EXPECT_TRUE(std::signbit(read.origin_mm.y()));
    EXPECT_EQ(bytes_of(read), bytes);
  }
}

TEST_F(RbfFile, MayHoldAPolynomialAlone) {
  RbfModel plane;
  plane.polynomial = {1.0, 2.0, 3.0, 4.0};
  EXPECT_EQ(bytes_of(plane).size(), 64U + 4U * 8U + 4U);
  EXPECT_EQ(read_rbf(path_).polynomial, plane.polynomial);
}

TEST_F(RbfFile, HasTheBytesThatItsDescriptionPromises) {
  const RbfModel model = odd_model(RadialKernel::triharmonic);
  const std::string bytes = bytes_of(model);
  const auto number_at = [&](std::size_t at) {
    double number = 0.0;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
  };
  EXPECT_EQ(bytes.substr(0, 16), std::string("STAPRBF\n\2\0\0\0\3\0\0\0", 16));
  EXPECT_EQ(number_at(16), 0.1);
  EXPECT_EQ(number_at(24), model.origin_mm.x());
  EXPECT_EQ(bytes.substr(48, 16), std::string("\2\0\0\0\0\0\0\0\12\0\0\0\0\0\0\0", 16));
  EXPECT_EQ(number_at(64), model.polynomial[0]);
  EXPECT_EQ(number_at(64 + 10 * 8 + 8), model.centres_mm[0].y());
  EXPECT_EQ(number_at(64 + 10 * 8 + 2 * 24 + 8), model.weights[1]);
  EXPECT_EQ(bytes.size(), 64U + 10U * 8U + 2U * 32U + 4U);
  EXPECT_EQ(sealed(bytes), bytes);
}

TEST_F(RbfFile, IsRejectedWhereverItIsCutShortOrDamaged) {
  const std::string bytes = bytes_of(odd_model(RadialKernel::biharmonic));
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_NE(error_reading(bytes.substr(0, size)), "") << size;
  EXPECT_NE(error_reading(bytes + '\0'), "");
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] ^= static_cast<char>(1 << (at % 8));
    EXPECT_NE(error_reading(damaged), "") << at;
  }
}

TEST_F(RbfFile, SaysWhatIsWrong) {
  const std::string bytes = bytes_of(odd_model(RadialKernel::biharmonic));
  EXPECT_THAT(error_reading("solid bone"), HasSubstr("another kind of file"));
  EXPECT_THAT(error_reading(with<std::uint32_t>(bytes, 8, 7)),
              HasSubstr("this is a version 7 radial basis function; version 2 is expected"));
  EXPECT_THAT(error_reading(with<std::uint32_t>(bytes, 12, 2)), HasSubstr("expected kernel 1 or 3, found 2"));
  EXPECT_THAT(error_reading(with<std::uint64_t>(bytes, 56, 10)), HasSubstr("expected 4 polynomial coefficients"));
  EXPECT_THAT(error_reading(bytes.substr(0, bytes.size() - 8)), HasSubstr("cut short"));
  std::string damaged = bytes;
  damaged[100] ^= 1;
  EXPECT_THAT(error_reading(damaged), HasSubstr("checksum"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_reading(with(bytes, 64 + 32, nan)), HasSubstr("a centre is not a number"));
  EXPECT_THAT(error_reading(with(bytes, 64 + 32 + 48, nan)), HasSubstr("a weight is not a number"));
  EXPECT_THAT(error_reading(with(bytes, 16, -1.0)), HasSubstr("expected a low-pass width of 0 mm or more, found -1"));
  EXPECT_THAT(error_of([&] { read_rbf(folder_.path() / "none.rbf"); }), HasSubstr("no such file"));
  EXPECT_THAT(error_of([&] { read_rbf(folder_.path()); }), HasSubstr("expected a regular file"));
}

TEST_F(RbfFile, BelievesNoCount) {
  const std::string bytes = bytes_of(odd_model(RadialKernel::biharmonic));
  // The third makes the product with 32 bytes overflow to the true size.
  for (const std::uint64_t count : {std::uint64_t{1}, std::uint64_t{1} << 62, (std::uint64_t{1} << 59) + 2}) {
    EXPECT_THAT(error_reading(with(bytes, 48, count)), HasSubstr("expected a file of " + std::to_string(count)));
  }
}

TEST_F(RbfFile, IsNotWrittenFromHalfAModelNorToAFullDisk) {
  RbfModel model = odd_model(RadialKernel::biharmonic);
  model.weights.pop_back();
  EXPECT_THAT(error_of([&] { write_rbf(model, path_); }), HasSubstr("expected a weight for each of 2 centres"));
  EXPECT_FALSE(std::filesystem::exists(path_));
  model.centres_mm.assign(1000, Vec3::Zero());
  model.weights.assign(1000, 0.0);
  const test::FullDisk full(4096);
  EXPECT_THAT(error_of([&] { write_rbf(model, path_); }), HasSubstr("cannot write"));
}

}  // namespace
}  // namespace spinaltap
