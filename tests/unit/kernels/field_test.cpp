#include "kernels/field.hpp"

#include <catch2/catch.hpp>
#include <cstdint>
#include <type_traits>

#include "kernels/boundary.hpp"
#include "kernels/velocity.hpp"
#include "tests/support/random_fields.hpp"

using namespace hourglass;

static_assert(!std::is_same_v<CellField, XFaceField>, "passing u where p is meant must not compile");
static_assert(!std::is_convertible_v<CellField, XFaceField>);
static_assert(std::is_same_v<rebind_t<VelocityOf<float>, double>, Velocity>);
static_assert(std::is_same_v<rebind_t<CellFieldOf<float>, double>, CellField>);

TEMPLATE_TEST_CASE("fields: extents, aligned rows, storage of their own for every point and halo", "",
                   CellField, XFaceField, YFaceField, CornerField, CellFieldOf<float>, CornerFieldOf<float>) {
  using T = typename TestType::value_type;
  for (const Patch& p :
       {Patch{1, 1, 1, 0, 0}, Patch{7, 5, 1, 0, 0}, Patch{128, 3, 1, 0, 0}, Patch{511, 2, 1, 0, 0}}) {
    TestType f(p);
    CHECK(f.nx() == p.nx + (TestType::location == At::xface || TestType::location == At::corner));
    CHECK(f.ny() == p.ny + (TestType::location == At::yface || TestType::location == At::corner));
    int number = 0;
    for (int j = -halo; j < f.ny() + halo; ++j)
      for (int i = -halo; i < f.nx() + halo; ++i) f(i, j) = static_cast<T>(++number);
    number = 0;
    bool own = true, aligned = true;
    for (int j = -halo; j < f.ny() + halo; ++j) {
      aligned = aligned && reinterpret_cast<std::uintptr_t>(f.row(j)) % 64 == 0;
      for (int i = -halo; i < f.nx() + halo; ++i) own = own && f(i, j) == static_cast<T>(++number);
    }
    CHECK(own);
    CHECK(aligned);
    CHECK(f.stride() * sizeof(T) % 1024 != 0);
    CHECK(f.bytes() >= static_cast<std::size_t>(number) * sizeof(T));
  }
}

TEST_CASE("fields: copies are deep, moves leave nothing, an empty field is free") {
  const Patch p{6, 4, 0.5, 0, 0};
  CellField a(p, 2.0);
  CellField b = a;
  b(1, 1) = 3;
  CHECK(a(1, 1) == 2);
  CHECK(b(-2, -2) == 2);  // halos are copied
  const double* where = b.row(0);
  b = a;
  CHECK(b.row(0) == where);  // same patch: no new allocation
  CellField c = std::move(a);
  CHECK_FALSE(a.allocated());  // NOLINT(bugprone-use-after-move): what moving leaves is what is asked
  CHECK(c(0, 0) == 2);
  CHECK(CellField().bytes() == 0);
  b.fill(1);
  b.swap(c);
  CHECK((b(0, 0) == 2 && c(0, 0) == 1));
}

TEST_CASE("patches: positions, and half the cells") {
  const Patch p{8, 6, 0.5, -1, 2};
  CHECK(p.x_corner(8) == 3);
  CHECK(p.y_corner(6) == 5);
  CHECK(p.x_centre(0) == -0.75);
  CHECK(p.cells() == 48);
  CHECK(p.coarser() == Patch{4, 3, 1, -1, 2});
}

TEST_CASE("rows of a velocity: every point once, u and v in turn") {
  const Patch p{5, 4, 1, 0, 0};
  Velocity w(p);
  long points = 0;
  for (int k = 0; k < row_count(w); ++k) {
    auto row = row_of(w, k);
    for (int i = 0; i < row.n; ++i) row.data[i] += 1;
    points += row.n;
    CHECK((k == 8 ? row.data == w.v.row(4) : row.data == (k % 2 ? w.v.row(k / 2) : w.u.row(k / 2))));
  }
  CHECK(points == 6 * 4 + 5 * 5);
  CHECK(inner_product(w, w) == points);
}

TEST_CASE("colours: every point has one, rows are mirror images, neighbours differ away from the middle") {
  for (int n : {1, 2, 5, 6, 17, 64}) {
    std::vector<int> colour[3];
    for (int j = 0; j < 3; ++j) {
      std::vector<float> row(n, -1);
      for (int c : {0, 1}) take_colour(std::vector<float>(n, c).data(), n, j, c, row.data());
      for (int i = 0; i < n; ++i) colour[j].push_back(static_cast<int>(row[i]));
      for (int i = 0; i < n; ++i) {
        CHECK((colour[j][i] == 0 || colour[j][i] == 1));
        CHECK(colour[j][i] == colour[j][n - 1 - i]);
        if (i > 0 && 2 * i != n) CHECK(colour[j][i] != colour[j][i - 1]);
        if (j > 0) CHECK(colour[j][i] != colour[j - 1][i]);
      }
    }
  }
}

TEST_CASE("halos of a periodic field repeat it") {
  const Patch p{6, 3, 1, 0, 0};
  Noise noise;
  CellField c(p);
  fill_random(c, noise);
  Boundary b;
  b.periodic_x = true;
  fill_cell_halo(b, c);
  for (int j = 0; j < 3; ++j)
    for (int k = 1; k <= halo; ++k) {
      CHECK(c(-k, j) == c(6 - k, j));
      CHECK(c(5 + k, j) == c(k - 1, j));
    }
  b.periodic_x = false;
  fill_cell_halo(b, c);
  CHECK((c(-2, 1) == c(0, 1) && c(7, 1) == c(5, 1) && c(-1, -1) == c(0, 0) && c(7, 4) == c(5, 2)));
}
