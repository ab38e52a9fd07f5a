// Lines and areas in one cell against polygon clipping, an independent way to the same areas.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "kernels/plic.hpp"
#include "kernels/polygon.hpp"

using namespace hourglass;

namespace {

/// {nx x + ny y <= alpha} as a polygon much larger than the unit square.
Polygon half_plane(double nx, double ny, double alpha) {
  const double size = std::hypot(nx, ny);
  const double a = nx / size, b = ny / size, d = alpha / size;  // unit normal, distance
  constexpr double far = 8;
  return {{a * d - far * b, b * d + far * a},
          {a * d + far * b, b * d - far * a},
          {a * (d - far) + far * b, b * (d - far) - far * a},
          {a * (d - far) - far * b, b * (d - far) + far * a}};
}

struct Random {
  std::mt19937_64 engine{7};
  double operator()(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(engine);
  }
};

/// Shares of a block that {nx x + ny y <= alpha} fills; the middle cell is the unit square.
void fill_block(double nx, double ny, double alpha, Block& block) {
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      block[1 + i][1 + j] = covered_fraction(half_plane(nx, ny, alpha), i, j, i + 1, j + 1);
}

}  // namespace

TEST_CASE("A polygon covers a rectangle", "[fast][polygon]") {
  const Polygon triangle{{0, 0}, {1, 0}, {0, 1}};
  CHECK(covered_fraction(triangle, 0, 0, 1, 1) == 0.5);
  CHECK(covered_fraction({{0, 1}, {1, 0}, {0, 0}}, 0, 0, 1, 1) == 0.5);  // the other way round
  CHECK(covered_fraction(triangle, 0, 0, 0.25, 0.5) == 1);
  CHECK(covered_fraction(triangle, 2, 2, 3, 3) == 0);
  CHECK(covered_fraction(triangle, 1, 0, 2, 1) == 0);
  CHECK(covered_fraction(triangle, -1, -1, 1, 1) == Approx(0.125).epsilon(1e-15));

  // An arrow head with a notch: its cells add up to its area by shoelace.
  const Polygon arrow{{0.1, 0.13}, {2.71, 1.5}, {0.2, 2.9}, {1.1, 1.4}};
  double twice_area = 0, sum = 0;
  for (int k = 0; k < 4; ++k)
    twice_area += arrow[k][0] * arrow[(k + 1) % 4][1] - arrow[(k + 1) % 4][0] * arrow[k][1];
  const double h = 3.0 / 17;
  for (int j = 0; j < 17; ++j)
    for (int i = 0; i < 17; ++i)
      sum += h * h * covered_fraction(arrow, i * h, j * h, (i + 1) * h, (j + 1) * h);
  CHECK(std::abs(sum - 0.5 * twice_area) < 1e-14);
}

TEST_CASE("Area below a line", "[fast][plic]") {
  CHECK(area_below(0.5, 0.5, 0.25) == 0.125);  // triangle
  CHECK(area_below(0.25, 0.75, 0.5) == Approx(0.5).epsilon(1e-15));
  CHECK(area_below(0, 1, 0.3) == 0.3);
  CHECK(area_below(1, 0, 0.3) == 0.3);
  CHECK(area_below(0.3, 0.7, -1e-30) == 0);
  CHECK(area_below(0.3, 0.7, 1) == 1);

  Random random;
  double worst = 0, worst_part = 0;
  for (int k = 0; k < 5000; ++k) {
    const double n1 = random(0, 1), n2 = 1 - n1, alpha = random(-0.1, 1.1);
    const Polygon phase = half_plane(n1, n2, alpha);
    worst = std::max(worst, std::abs(area_below(n1, n2, alpha) - covered_fraction(phase, 0, 0, 1, 1)));
    const double x = random(0, 1), y = random(0, 1), dx = random(0, 1 - x), dy = random(0, 1 - y);
    const double part = covered_fraction(phase, x, y, x + dx, y + dy) * dx * dy;
    worst_part = std::max(worst_part, std::abs(area_in_rectangle(n1, n2, alpha, x, y, dx, dy) - part));
  }
  CHECK(worst < 1e-14);
  CHECK(worst_part < 1e-14);
}

TEST_CASE("From share to line and back", "[fast][plic]") {
  Random random;
  double worst = 0;
  const std::array<double, 6> thin{0, 1e-300, 1e-16, 1e-12, 1e-6, 0.5};
  const std::array<double, 7> shares{1e-300, 1e-12, 1e-6, 0.5, 1 - 1e-6, 1 - 1e-12, 1};
  const auto there_and_back = [&](double n1, double c) {
    worst = std::max(worst, std::abs(area_below(n1, 1 - n1, line_constant(n1, 1 - n1, c)) - c));
    worst = std::max(worst, std::abs(area_below(1 - n1, n1, line_constant(1 - n1, n1, c)) - c));
  };
  for (double n1 : thin)
    for (double c : shares) there_and_back(n1, c);
  for (int k = 0; k < 20000; ++k) {
    there_and_back(random(0, 1), random(0, 1));
    there_and_back(random(0, 1), 1e-12 * random(0, 1));
    there_and_back(1e-12 * random(0, 1), random(0, 1));
    there_and_back(random(0, 1), 1 - 1e-12 * random(0, 1));
  }
  CHECK(worst < 1e-14);
}

TEST_CASE("A straight interface is reconstructed exactly, at any angle", "[fast][plic]") {
  Random random;
  double worst_normal = 0, worst_alpha = 0;
  for (int k = 0; k < 20000; ++k) {
    const double angle = k < 16 ? k * std::acos(-1) / 8 : random(0, 6.3);
    double nx = std::cos(angle), ny = std::sin(angle);
    const double size = std::abs(nx) + std::abs(ny);
    nx /= size;
    ny /= size;
    const double alpha = random(0.05, 0.95);  // from the corner that fills first
    Block block;
    fill_block(nx, ny, alpha + std::min(0.0, nx) + std::min(0.0, ny), block);
    const Line line = reconstruct(block);
    worst_normal = std::max({worst_normal, std::abs(line.nx - nx), std::abs(line.ny - ny)});
    worst_alpha = std::max(worst_alpha, std::abs(line.alpha - alpha));
  }
  CHECK(worst_normal < 1e-12);
  CHECK(worst_alpha < 1e-12);
}

TEST_CASE("A mirrored block gives the mirrored line, to the last bit", "[fast][plic]") {
  Random random;
  for (int k = 0; k < 20000; ++k) {
    Block block, in_x, in_y;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double c = random(-0.5, 1.5);
        block[i][j] = in_x[2 - i][j] = in_y[i][2 - j] =
            i == 1 && j == 1 ? random(0, 1) : std::clamp(c, 0.0, 1.0);
      }
    const Line line = reconstruct(block), x = reconstruct(in_x), y = reconstruct(in_y);
    REQUIRE((x.nx == -line.nx && x.ny == line.ny && x.alpha == line.alpha));
    REQUIRE((y.nx == line.nx && y.ny == -line.ny && y.alpha == line.alpha));
    const double shift = random(0, 0.5);
    REQUIRE(area_leaving(block, shift) == area_leaving(in_x, -shift));
    REQUIRE(area_leaving(block, shift) == area_leaving(in_y, shift));
  }
}

TEST_CASE("A block that shows no direction gives none", "[fast][plic]") {
  const Block drop = {{0, 0, 0}, {0, 0.3, 0}, {0, 0, 0}};
  const Block thread = {{0, 0.3, 0}, {0, 0.3, 0}, {0, 0.3, 0}};
  for (const Block* block : {&drop, &thread}) {
    const Line line = reconstruct(*block);
    CHECK((line.nx == 0 && line.ny == 0));
    CHECK(area_leaving(*block, 0.2) == Approx(0.2 * 0.3).epsilon(1e-15));
  }
}

TEST_CASE("What leaves is what the strip holds", "[fast][plic]") {
  Random random;
  for (int k = 0; k < 20000; ++k) {
    Block block;
    for (auto& column : block)
      for (double& c : column) c = std::clamp(random(-0.5, 1.5), 0.0, 1.0);
    const double tiny = 1e-12;
    block[1][1] = k % 3 == 0 ? random(0, 1) : k % 3 == 1 ? tiny : 1 - tiny;
    const double c = block[1][1], width = random(0, 1);
    const double right = area_leaving(block, width), left = area_leaving(block, -(1 - width));
    REQUIRE(std::abs(right + left - c) < 1e-14);
    REQUIRE((right >= 0 && right <= std::min(c, width)));
    REQUIRE(width - right <= 1 - c + 1e-15);  // nor more air than there is
  }

  Block line;
  fill_block(0.3, -0.7, -0.2, line);  // against the half-plane it came from
  const Polygon phase = half_plane(0.3, -0.7, -0.2);
  CHECK(area_leaving(line, 0.25) == Approx(0.25 * covered_fraction(phase, 0.75, 0, 1, 1)).epsilon(1e-13));
  CHECK(area_leaving(line, -0.25) == Approx(0.25 * covered_fraction(phase, 0, 0, 0.25, 1)).epsilon(1e-13));
}
