#include "io/xdmf.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace hourglass;
namespace fs = std::filesystem;

namespace {

/// A folder that lives as long as the test.
struct Folder {
  fs::path path = fs::temp_directory_path() / fmt::format("hourglass_xdmf_test_{}", ::getpid());
  Folder() {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
};

RunInfo info_of_patch(const Patch& patch) {
  RunInfo info;
  info.name = "two <holes> & \"a half\"";
  info.units = Units::SI;
  info.patch = patch;
  info.walls = {Wall::periodic, Wall::periodic, Wall::no_slip, Wall::open};
  info.orifices = {{Side::bottom, 1.25, 0.5}, {Side::right, 0.75, 0.25}};
  info.materials = {"sand", "röd"};
  info.symmetry = Symmetry::mirror;
  info.coordinates = Coordinates::axisymmetric;
  info.solids = {{{0.5, -1}, {1, -1}, {0.5, 0}}, Polygon(720, {1.0 / 3, 0.1})};
  info.slow_speed = 1e-3 / 3;
  return info;
}

/// Values that tell frame, field and cell apart.
double value_of(int k, int field, int i, int j) { return 1000 * k + 100 * field + 10 * j + i + 0.25; }

Frame frame_number(int k, const Patch& patch) {
  Frame frame;
  frame.t = 0.1 * k;
  const auto field = [&](int number) {
    CellField f(patch);
    for (int j = 0; j < patch.ny; ++j) {
      for (int i = 0; i < patch.nx; ++i) f(i, j) = value_of(k, number, i, j);
    }
    return f;
  };
  frame.fields = {{"speed", field(0)}, {"grains", field(1)}};
  frame.velocity_x = field(2);
  frame.velocity_y = field(3);
  return frame;
}

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

int count(const std::string& text, const std::string& what) {
  int n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

/// Every frame that fields.xdmf lists can be read from fields.h5 with the values that were written.
int frames_intact(const fs::path& folder, const Patch& patch) {
  const std::string xdmf = text_of(folder / "fields.xdmf");
  REQUIRE(xdmf.find("</Xdmf>") != std::string::npos);
  REQUIRE(count(xdmf, "<Grid ") == count(xdmf, "</Grid>"));
  const int listed = count(xdmf, "<Time ");
  const FieldReader reader(folder);
  REQUIRE(static_cast<int>(reader.times().size()) >= listed);
  for (int k = 0; k < listed; ++k) {
    const Frame frame = reader.read(k, {"speed", "grains"});
    CHECK(frame.t == 0.1 * k);
    CHECK(frame.field("speed")(patch.nx - 1, 0) == value_of(k, 0, patch.nx - 1, 0));
    CHECK(frame.field("grains")(0, patch.ny - 1) == value_of(k, 1, 0, patch.ny - 1));
    CHECK(frame.velocity_y(1, 2) == value_of(k, 3, 1, 2));
  }
  return listed;
}

}  // namespace

TEST_CASE("fields come back as they were written, with the geometry", "[io]") {
  const Patch patch{10, 6, 0.25, 0.5, -1};
  const int deflate = GENERATE(0, 4);
  const Folder folder;
  FieldWriter writer(folder.path, info_of_patch(patch), deflate);
  for (int k = 0; k < 3; ++k) writer.write(frame_number(k, patch));

  const FieldReader reader(folder.path);
  const RunInfo wrote = info_of_patch(patch);
  const RunInfo& read = reader.info();
  CHECK(read.name == wrote.name);
  CHECK(read.units == wrote.units);
  CHECK(read.patch == wrote.patch);
  CHECK(read.walls == wrote.walls);
  CHECK(read.orifices == wrote.orifices);
  CHECK(read.materials == wrote.materials);
  CHECK(read.symmetry == wrote.symmetry);
  CHECK(read.coordinates == wrote.coordinates);
  CHECK(read.solids == wrote.solids);
  CHECK(read.slow_speed == wrote.slow_speed);
  CHECK(reader.names(1) == std::vector<std::string>{"grains", "speed"});
  CHECK(frames_intact(folder.path, patch) == 3);
  CHECK_THROWS_AS(reader.read(0, {"pressure"}), std::invalid_argument);
  CHECK_THROWS_WITH(reader.read(0, {"pressure"}), Catch::Contains("grains, speed"));
}

TEST_CASE("XDMF names every dataset, with origin, spacing and time", "[io]") {
  const Patch patch{10, 6, 0.25, 0.5, -1};
  const Folder folder;
  FieldWriter writer(folder.path, info_of_patch(patch));
  for (int k = 0; k < 2; ++k) writer.write(frame_number(k, patch));

  const std::string xdmf = text_of(folder.path / "fields.xdmf");
  CHECK(count(xdmf, "CollectionType=\"Temporal\"") == 1);
  CHECK(count(xdmf, "Name=\"two &lt;holes&gt; &amp; &quot;a half&quot;\"") == 3);
  CHECK(count(xdmf, "Dimensions=\"2 7 11\"") == 2);       // nodes z, y, x
  CHECK(count(xdmf, ">-0.125 -1 0.5</DataItem>") == 2);   // origin z, y, x
  CHECK(count(xdmf, ">0.25 0.25 0.25</DataItem>") == 2);  // spacing
  CHECK(count(xdmf, "Dimensions=\"1 6 10\"") == 4);       // two scalars in two frames
  CHECK(count(xdmf, "Dimensions=\"1 6 10 3\"") == 2);     // velocity
  CHECK(count(xdmf, "<Time Value=\"0.1\"/>") == 1);
  CHECK(count(xdmf, "fields.h5:/frames/000001/velocity</DataItem>") == 1);
}

TEST_CASE("a folder without a readable fields.h5 is refused with its name", "[io]") {
  const Folder folder;
  CHECK_THROWS_WITH(FieldReader(folder.path), Catch::Contains("fields.h5: No such file or directory"));
  std::ofstream(folder.path / "fields.h5") << "no HDF5";
  CHECK_THROWS_WITH(FieldReader(folder.path), Catch::Contains("fields.h5: "));
}

TEST_CASE("a killed process leaves every frame that it had announced", "[io]") {
  const Patch patch{40, 30, 1, 0, 0};
  for (int attempt = 0; attempt < 10; ++attempt) {
    const Folder folder;
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      FieldWriter writer(folder.path, info_of_patch(patch));
      for (int k = 0;; ++k) writer.write(frame_number(k, patch));
    }
    while (!fs::exists(folder.path / "fields.xdmf")) ::usleep(1000);
    ::usleep(10000 + 3571 * attempt);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    INFO("attempt " << attempt);
    CHECK(frames_intact(folder.path, patch) > 0);
  }
}

TEST_CASE("a full disk is an error with path and reason; earlier frames stay", "[io]") {
  const Patch patch{40, 30, 1, 0, 0};
  const Folder folder;
  FieldWriter writer(folder.path, info_of_patch(patch));
  writer.write(frame_number(0, patch));
  writer.write(frame_number(1, patch));

  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{fs::file_size(folder.path / "fields.h5") + 5000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &tight);
  CHECK_THROWS_WITH(writer.write(frame_number(2, patch)),
                    Catch::Contains("fields.h5: ") && Catch::Contains("File too large"));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);

  CHECK(frames_intact(folder.path, patch) == 2);
  writer.write(frame_number(2, patch));  // room again
  CHECK(frames_intact(folder.path, patch) == 3);
}
