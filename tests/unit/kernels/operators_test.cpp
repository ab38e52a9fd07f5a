// The viscous and the pressure operator on one patch: energies, exactness, relaxation, transfers between levels.
#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/support/boundaries.hpp"
#include "tests/support/make_operator.hpp"

using namespace hourglass;

namespace {

const Patch odd{9, 7, 0.37, -1, 2};
const Patch even{10, 8, 0.37, -1, 2};

/// The bilinear form whose matrix A is, straight from the definition: x, y with zeros beyond the patch.
double energy_form(const ViscousCoefficients<double>& a, const Velocity& x, const Velocity& y,
                   bool periodic) {
  const int nx = a.eta_c.nx(), ny = a.eta_c.ny();
  double sum = 0;
  const int faces = periodic ? nx : nx + 1;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < faces; ++i) sum += a.mass.u(i, j) * x.u(i, j) * y.u(i, j);
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i < nx; ++i) sum += a.mass.v(i, j) * x.v(i, j) * y.v(i, j);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const auto dxu = [&](const Velocity& w) { return w.u(i + 1, j) - w.u(i, j); };
      const auto dyv = [&](const Velocity& w) { return w.v(i, j + 1) - w.v(i, j); };
      sum += 2 * a.eta_c(i, j) * (dxu(x) * dxu(y) + dyv(x) * dyv(y));
    }
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i < faces; ++i) {
      const auto shear = [&](const Velocity& w) {
        return (w.u(i, j) - w.u(i, j - 1)) + (w.v(i, j) - w.v(i - 1, j));
      };
      sum += a.eta_n(i, j) * shear(x) * shear(y);
    }
  return sum;
}

/// A velocity in two variables on all faces, halos included.
template <class U, class V>
Velocity sampled(const Patch& p, U&& u, V&& v) {
  Velocity w(p);
  for (int j = -1; j <= p.ny; ++j)
    for (int i = -1; i <= p.nx + 1; ++i) w.u(i, j) = u(p.x_corner(i), p.y_centre(j));
  for (int j = -1; j <= p.ny + 1; ++j)
    for (int i = -1; i <= p.nx; ++i) w.v(i, j) = v(p.x_centre(i), p.y_corner(j));
  return w;
}

/// Red-black, counted from the nearer end of a row of n points.
int colour_of(int i, int j, int n) { return (std::min(i, n - 1 - i) + j) % 2; }

Velocity random_admissible(const ViscousCoefficients<double>& a, const Boundary& b, Noise& noise) {
  Velocity x(a.eta_c.patch());
  fill_random(x, noise);
  make_admissible(a, b, x);
  return x;
}

}  // namespace

TEST_CASE("the viscous operator is the matrix of the discrete energy, at every boundary and contrast 1e8") {
  Noise noise;
  for (const Patch& p : {odd, even})
    for (const auto& [name, b] : all_kinds_of_boundaries(p.nx, p.ny)) {
      INFO(name << ' ' << p.nx << " x " << p.ny);
      const auto a = random_viscous<double>(p, b, noise, 1e8);
      const Velocity x = random_admissible(a, b, noise), y = random_admissible(a, b, noise);
      const Velocity ax = apply(a, x), ay = apply(a, y);
      const double xax = inner_product(x, ax, b.periodic_x), yay = inner_product(y, ay, b.periodic_x);
      const double scale = 1e-13 * std::sqrt(xax * yay);
      CHECK(xax > 0);
      CHECK(std::abs(inner_product(x, ay, b.periodic_x) - inner_product(y, ax, b.periodic_x)) <= scale);
      CHECK(std::abs(inner_product(x, ay, b.periodic_x) - energy_form(a, x, y, b.periodic_x)) <= scale);
      CHECK(xax == Approx(energy_form(a, x, x, b.periodic_x)).epsilon(1e-13));
    }
}

TEST_CASE("the viscous operator is exact for quadratic velocities and linear viscosities inside") {
  const double eta_0 = 3, eta_x = 0.7, eta_y = -0.4, mass = 0.11;
  const auto eta = [&](double x, double y) { return eta_0 + eta_x * x + eta_y * y; };
  const auto u = [](double x, double y) { return 1 + 2 * x - y + 0.3 * x * x - 0.8 * x * y + 0.5 * y * y; };
  const auto v = [](double x, double y) {
    return -2 + 0.6 * x + y - 0.9 * x * x + 0.2 * x * y - 0.7 * y * y;
  };
  // div(2 eta D) with D from u and v above; arithmetic corners are exact where eta is linear.
  const auto force_x = [&](double x, double y) {
    const double dxu = 2 + 0.6 * x - 0.8 * y, shear = (-1 - 0.8 * x + y) + (0.6 - 1.8 * x + 0.2 * y);
    return 2 * eta_x * dxu + eta_y * shear + eta(x, y) * (2 * 0.6 + 1.0 + 0.2);
  };
  const auto force_y = [&](double x, double y) {
    const double dyv = 1 + 0.2 * x - 1.4 * y, shear = (-1 - 0.8 * x + y) + (0.6 - 1.8 * x + 0.2 * y);
    return 2 * eta_y * dyv + eta_x * shear + eta(x, y) * (2 * -1.4 + -0.8 - 1.8);
  };
  const Boundary b = all_kinds_of_boundaries(odd.nx, odd.ny)[0].boundary;
  const auto a = viscous_coefficients<double>(odd, b, eta, mass, false);
  const Velocity w = sampled(odd, u, v), aw = apply(a, w);
  const double area = odd.h * odd.h;
  double worst = 0;
  for (int j = 1; j < odd.ny - 1; ++j)
    for (int i = 1; i < odd.nx; ++i)
      worst = std::max(
          worst, std::abs(aw.u(i, j) - mass * w.u(i, j) + area * force_x(odd.x_corner(i), odd.y_centre(j))));
  for (int j = 1; j < odd.ny; ++j)
    for (int i = 1; i < odd.nx - 1; ++i)
      worst = std::max(
          worst, std::abs(aw.v(i, j) - mass * w.v(i, j) + area * force_y(odd.x_centre(i), odd.y_corner(j))));
  CHECK(worst < 1e-13);
}

TEST_CASE("a body that moves as a whole feels no viscous force, whatever its viscosity") {
  Noise noise;
  const Boundary open = all_kinds_of_boundaries(odd.nx, odd.ny)[4].boundary;  // no wall to hold it
  auto a = random_viscous<double>(odd, open, noise, 1e8);
  a.mass.fill(0);
  const double U = 1.7, V = -0.3, omega = 2.1;
  const auto largest_force = [&](const Velocity& w) {
    const Velocity f = apply(a, w);
    double m = 0;
    for (int k = 0; k < row_count(f); ++k)
      for (int i = 0; i < row_of(f, k).n; ++i) m = std::max(m, std::abs(row_of(f, k).data[i]));
    return m;
  };
  const Velocity still = sampled(
      odd, [&](double, double) { return U; }, [&](double, double) { return V; });
  CHECK(largest_force(still) == 0);  // differences come first: exact, in float too
  const Velocity rotation = sampled(
      odd, [&](double, double y) { return U - omega * y; }, [&](double x, double) { return V + omega * x; });
  CHECK(largest_force(rotation) < 1e8 * 1e-14);  // eta eps u
}

TEST_CASE("relaxation of the viscous rows is Gauss-Seidel") {
  Noise noise;
  const auto test = [&](auto zero, double tolerance) {
    using T = decltype(zero);
    for (const Patch& p : {odd, even})
      for (const auto& [name, boundary] : all_kinds_of_boundaries(p.nx, p.ny)) {
        INFO(name << ' ' << p.nx << " x " << p.ny << ' ' << sizeof(T));
        const auto a = random_viscous<T>(p, boundary, noise, 1e3);
        VelocityOf<T> x(p), b(p);
        fill_random(x, noise);
        fill_random(b, noise);
        make_admissible(a, boundary, x);
        VelocityOf<T> plain = x;
        std::vector<T> scratch(p.nx + 1);
        for (int colour : {0, 1}) {
          for (int j = 0; j < p.ny; ++j) {
            relax_u_row(a, x, b, j, colour, scratch.data());
            if (boundary.periodic_x) wrap_row(x.u.row(j), p.nx);
          }
          for (int j = 0; j <= p.ny; ++j) {
            relax_v_row(a, x, b, j, colour, scratch.data());
            if (boundary.periodic_x) wrap_row(x.v.row(j), p.nx);
          }
          // x_k <- (b_k - sum over l != k of A_kl x_l) / A_kk, with A read off by apply().
          for (int k = 0; k < 2; ++k) {
            VelocityOf<T> before = plain;
            const VelocityOf<T> ax = apply(a, before);
            const auto sweep = [&](auto& out, const auto& now, const auto& rhs, const auto& force,
                                   const auto& inv) {
              for (int j = 0; j < out.ny(); ++j)
                for (int i = 0; i < out.nx(); ++i)
                  if (colour_of(i, j, out.nx()) == colour)
                    out(i, j) = now(i, j) + inv(i, j) * (rhs(i, j) - force(i, j));
            };
            if (k == 0) sweep(plain.u, before.u, b.u, ax.u, a.inverse_diagonal.u);
            if (k == 1) sweep(plain.v, before.v, b.v, ax.v, a.inverse_diagonal.v);
            make_admissible(a, boundary, plain);
          }
        }
        double worst = 0;
        for (int k = 0; k < row_count(x); ++k)
          for (int i = 0; i < row_of(x, k).n; ++i)
            worst =
                std::max(worst, std::abs(double(row_of(x, k).data[i]) - double(row_of(plain, k).data[i])));
        CHECK(worst < tolerance);
      }
  };
  test(0.0, 1e-13);
  test(0.0f, 1e-4);
}

TEST_CASE("an update leaves no residual at its points, but for the two that share a colour at the middle") {
  Noise noise;
  for (const Patch& p : {odd, even})
    for (const auto& [name, boundary] : all_kinds_of_boundaries(p.nx, p.ny)) {
      if (boundary.periodic_x) continue;  // there the ends of a row share a colour as well
      INFO(name << ' ' << p.nx << " x " << p.ny);
      const auto a = random_viscous<double>(p, boundary, noise, 1e4);
      Velocity x = random_admissible(a, boundary, noise), b(p);
      fill_random(b, noise);
      std::vector<double> scratch(p.nx + 1);
      for (int j = 0; j < p.ny; ++j) relax_u_row(a, x, b, j, 1, scratch.data());
      const Velocity ax = apply(a, x);
      const int n = x.u.nx();
      double worst = 0;
      for (int j = 0; j < p.ny; ++j)
        for (int i = 0; i < n; ++i)
          if (colour_of(i, j, n) == 1 && (n % 2 == 1 || (i != n / 2 && i != n / 2 - 1)))
            worst = std::max(worst, a.inverse_diagonal.u(i, j) * std::abs(b.u(i, j) - ax.u(i, j)));
      CHECK(worst < 1e-14);
    }
}

TEST_CASE("restriction of the viscous residual is the transpose of prolongation") {
  Noise noise;
  const Patch fine_patch{12, 16, 0.5, 0, 0}, coarse_patch = fine_patch.coarser();
  for (const auto& [name, boundary] : all_kinds_of_boundaries(fine_patch.nx, fine_patch.ny)) {
    INFO(name);
    const Boundary coarser = boundary.coarser();
    const auto a = random_viscous<double>(fine_patch, boundary, noise, 1e3);
    const Velocity r = random_admissible(a, boundary, noise);
    Velocity c(coarse_patch), rc(coarse_patch), pc(fine_patch);
    fill_random(c, noise);
    for (int k = 0; coarser.periodic_x && k < row_count(c); ++k) wrap_row(row_of(c, k).data, coarse_patch.nx);
    Team alone;
    restrict_viscous(alone, r, coarser, rc);
    prolong_viscous(alone, c, coarser, a.inverse_diagonal, pc);
    const double there = inner_product(pc, r, boundary.periodic_x),
                 here = inner_product(c, rc, boundary.periodic_x);
    CHECK(std::abs(there - here) < 1e-12);
  }
}

TEST_CASE("prolongation reproduces rigid motions, and linear flow, inside") {
  const Patch fine_patch{16, 12, 0.25, -1, 3}, coarse_patch = fine_patch.coarser();
  const auto u = [](double x, double y) { return 0.4 + 0.3 * x - 2.1 * y; };
  const auto v = [](double x, double y) { return -0.8 + 2.1 * x + 1.3 * y; };
  const Boundary open = all_kinds_of_boundaries(fine_patch.nx, fine_patch.ny)[4].boundary;
  const auto a = viscous_coefficients<double>(
      fine_patch, open, [](double, double) { return 1.0; }, 1.0);
  const Velocity exact = sampled(fine_patch, u, v), coarse = sampled(coarse_patch, u, v);
  Velocity fine(fine_patch);
  Team alone;
  prolong_viscous(alone, coarse, open.coarser(), a.inverse_diagonal, fine);
  double worst = 0;
  for (int j = 1; j < fine_patch.ny - 1; ++j)
    for (int i = 0; i <= fine_patch.nx; ++i) worst = std::max(worst, std::abs(fine.u(i, j) - exact.u(i, j)));
  for (int j = 0; j <= fine_patch.ny; ++j)
    for (int i = 1; i < fine_patch.nx - 1; ++i)
      worst = std::max(worst, std::abs(fine.v(i, j) - exact.v(i, j)));
  CHECK(worst < 1e-13);
}

TEST_CASE("coarse viscous coefficients: constants stay, masses add up, values stay between the fine ones") {
  Noise noise;
  const Patch fine_patch{12, 16, 0.5, 0, 0};
  for (const auto& [name, boundary] : all_kinds_of_boundaries(fine_patch.nx, fine_patch.ny)) {
    INFO(name);
    const Boundary coarser = boundary.coarser();
    Team alone;
    ViscousCoefficients<double> coarse(fine_patch.coarser());
    coarsen_viscous(alone,
                    viscous_coefficients<double>(
                        fine_patch, boundary, [](double, double) { return 3.0; }, 0.5),
                    boundary.periodic_x, coarse);
    for (int j = 0; j < coarse.eta_c.ny(); ++j)
      for (int i = 0; i < coarse.eta_c.nx(); ++i) CHECK(coarse.eta_c(i, j) == Approx(3).epsilon(1e-14));
    CHECK(coarse.eta_n(2, 3) == Approx(3).epsilon(1e-14));
    CHECK(coarse.mass.u(2, 3) == Approx(2).epsilon(1e-14));
    CHECK(coarse.mass.v(2, 3) == Approx(2).epsilon(1e-14));
    if (!boundary.periodic_x) CHECK(coarse.mass.u(0, 3) == Approx(1).epsilon(1e-14));
    CHECK(coarse.mass.v(2, 0) == Approx(1).epsilon(1e-14));

    const auto fine = random_viscous<double>(fine_patch, boundary, noise, 1e8);
    coarsen_viscous(alone, fine, boundary.periodic_x, coarse);
    for (int j = 0; j < coarse.eta_c.ny(); ++j)
      for (int i = 0; i < coarse.eta_c.nx(); ++i)
        CHECK((coarse.eta_c(i, j) >= 1 && coarse.eta_c(i, j) <= 1e8));
  }
}

TEST_CASE("the pressure operator is symmetric and positive, and 0 for a constant in a closed box") {
  Noise noise;
  for (const Patch& p : {odd, even})
    for (const auto& [name, b] : all_kinds_of_boundaries(p.nx, p.ny)) {
      INFO(name << ' ' << p.nx << " x " << p.ny);
      const auto a = random_poisson<double>(p, b, noise, 1e3);
      const auto random = [&, periodic = b.periodic_x] {
        CellField q(p);
        fill_random(q, noise);
        for (int j = 0; periodic && j < p.ny; ++j) wrap_row(q.row(j), p.nx);
        return q;
      };
      const CellField x = random(), y = random();
      const CellField ax = apply(a, x), ay = apply(a, y);
      const double xax = inner_product(x, ax), yay = inner_product(y, ay);
      CHECK(xax > 0);
      CHECK(std::abs(inner_product(x, ay) - inner_product(y, ax)) <= 1e-13 * std::sqrt(xax * yay));

      CellField one(p);
      for (int j = 0; j < p.ny; ++j) {
        for (int i = 0; i < p.nx; ++i) one(i, j) = 1;
        if (b.periodic_x) wrap_row(one.row(j), p.nx);
      }
      // What is left of a constant: the flux to p = 0 through open faces.
      double through_open = 0;
      for (int i = 0; i < p.nx; ++i) through_open += a.beta.v(i, 0) + a.beta.v(i, p.ny);
      for (int j = 0; !b.periodic_x && j < p.ny; ++j) through_open += a.beta.u(0, j) + a.beta.u(p.nx, j);
      CHECK(inner_product(one, apply(a, one)) == Approx(through_open).epsilon(1e-12).margin(1e-10));
    }
}

TEST_CASE("the pressure operator is exact for quadratics in a uniform medium") {
  const double rho = 2.5;
  PoissonCoefficients<double> a(odd);
  a.beta.u.fill(1 / rho);
  a.beta.v.fill(1 / rho);
  CellField q(odd);
  for (int j = -1; j <= odd.ny; ++j)
    for (int i = -1; i <= odd.nx; ++i) {
      const double x = odd.x_centre(i), y = odd.y_centre(j);
      q(i, j) = 1 - x + 3 * y + 0.8 * x * x - 0.3 * x * y + 1.4 * y * y;
    }
  const CellField aq = apply(a, q);
  for (int j = 1; j < odd.ny - 1; ++j)
    for (int i = 1; i < odd.nx - 1; ++i)
      CHECK(aq(i, j) == Approx(-odd.h * odd.h * (1.6 + 2.8) / rho).epsilon(1e-12));
}

TEST_CASE("relaxation of the pressure rows is red-black Gauss-Seidel") {
  Noise noise;
  for (const Patch& p : {odd, even})
    for (const auto& [name, boundary] : all_kinds_of_boundaries(p.nx, p.ny)) {
      INFO(name << ' ' << p.nx << " x " << p.ny);
      const auto a = random_poisson<double>(p, boundary, noise, 1e3);
      CellField x(p), b(p);
      fill_random(x, noise);
      fill_random(b, noise);
      const auto wrap = [&, periodic = boundary.periodic_x](CellField& f) {
        for (int j = 0; periodic && j < p.ny; ++j) wrap_row(f.row(j), p.nx);
      };
      wrap(x);
      CellField plain = x;
      std::vector<double> scratch(p.nx);
      for (int colour : {0, 1}) {
        for (int j = 0; j < p.ny; ++j) relax_poisson_row(a, x, b, j, colour, scratch.data());
        wrap(x);
        const CellField old = plain;
        for (int j = 0; j < p.ny; ++j)
          for (int i = 0; i < p.nx; ++i) {
            if (colour_of(i, j, p.nx) != colour) continue;
            const double w = a.beta.u(i, j), e = a.beta.u(i + 1, j), s = a.beta.v(i, j),
                         n = a.beta.v(i, j + 1);
            plain(i, j) =
                (b(i, j) + e * old(i + 1, j) + w * old(i - 1, j) + n * old(i, j + 1) + s * old(i, j - 1)) /
                (w + e + s + n);
          }
        wrap(plain);
      }
      double worst = 0;
      for (int j = 0; j < p.ny; ++j)
        for (int i = 0; i < p.nx; ++i) worst = std::max(worst, std::abs(x(i, j) - plain(i, j)));
      CHECK(worst < 1e-13);
    }
}

TEST_CASE(
    "coarse pressure coefficients are means of faces, and an orifice of one cell stays open on every level") {
  const int n = 32;
  Patch p{n, n, 1, 0, 0};
  Boundary b = all_kinds_of_boundaries(n, n)[0].boundary;
  b.bottom = pierced_side(n, no_slip, 13, 14, 1);
  PoissonCoefficients<double> a(p);
  for (int j = 0; j < n; ++j)
    for (int i = 1; i < n; ++i) a.beta.u(i, j) = 1;
  for (int j = 1; j < n; ++j)
    for (int i = 0; i < n; ++i) a.beta.v(i, j) = 1;
  a.beta.v(13, 0) = 2;
  Team alone;
  double share = 1;
  while (p.nx > 2) {
    PoissonCoefficients<double> coarse(p.coarser());
    coarsen_poisson(alone, a, coarse);
    p = p.coarser();
    b = b.coarser();
    share /= 2;
    double open = 0, beta = 0;
    for (int i = 0; i < p.nx; ++i) {
      open += b.bottom.open[i];
      beta += coarse.beta.v(i, 0);
    }
    CHECK(open == Approx(share));
    CHECK(beta == Approx(2 * share));
    CHECK(b.any_open());
    CHECK(coarse.beta.u(1, 0) == Approx(1));
    a = std::move(coarse);
  }
}

TEST_CASE("the pressure's restriction sums cells") {
  Noise noise;
  const Patch p{12, 8, 1, 0, 0};
  CellField fine(p), coarse(p.coarser());
  fill_random(fine, noise);
  Team alone;
  restrict_poisson(alone, fine, coarse);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 6; ++i)
      CHECK(coarse(i, j) == Approx(fine(2 * i, 2 * j) + fine(2 * i + 1, 2 * j) + fine(2 * i, 2 * j + 1) +
                                   fine(2 * i + 1, 2 * j + 1))
                                .margin(1e-15));
}
