// Granular laws by table, and the viscosity rows that they feed.
#include "kernels/rheology.hpp"

#include <catch2/catch.hpp>

#include "tests/support/boundaries.hpp"
#include "tests/support/random_fields.hpp"

using namespace hourglass;

namespace {

const Grain medium{0.62, 0.48, 0.6, 1, 1};
const Grain low{0.47, 0.38, 0.6, 1, 1};
const Grain smooth_beads{0.32, 0.28, 0.4, 1, 1};
constexpr ViscosityLimits limits{1, 1e6, 0.0164, 0};

double viscosity(double gamma2, double p, double grains, const Grain& g, const ViscosityLimits& l = limits) {
  double eta = 0;
  granular_viscosity_row(&gamma2, &p, &grains, 1, g, l, &eta);
  return eta;
}

}  // namespace

TEST_CASE("mu(I): a table") {
  CHECK(mu_of_I(0, medium) == 0.62);
  CHECK(mu_of_I(0.6, medium) == Approx(0.62 + 0.24));
  CHECK(mu_of_I(1e12, medium) == Approx(1.10));
  CHECK(mu_of_I(0.1, smooth_beads) == Approx(0.32 + 0.28 * 0.2));
  // tan(alpha) = mu(I) on an incline of 0.40 rad: I = 0.232030 (Bagnold flow of the verification suite).
  CHECK(mu_of_I(0.232030, smooth_beads) == Approx(std::tan(0.40)).epsilon(1e-5));
}

TEST_CASE("inertial number: definition, units, and no pressure at all") {
  CHECK(inertial_number(2, 4, medium) == Approx(1));
  const Grain sand{0.5, 0.3, 0.3, 1e-3, 1500};  // SI
  CHECK(inertial_number(10, 600, sand) == Approx(10 * 1e-3 * std::sqrt(1500. / 600)));
  CHECK(inertial_number(1, 0, medium) > 1e100);
  CHECK(std::isfinite(inertial_number(1, 0, medium)));
}

TEST_CASE("granular viscosity is mu(I) P / |γ̇|") {
  Noise noise;
  for (const Grain& g : {medium, low, smooth_beads, Grain{0.5, 0.3, 0.3, 1e-3, 1500}})
    for (int k = 0; k < 50; ++k) {
      const double rate = noise.logarithmic(1e-8, 1e3), pressure = noise.logarithmic(1e-6, 1e4);
      const double eta = granular_viscosity(rate, pressure, g);
      CHECK(eta == Approx(mu_of_I(inertial_number(rate, pressure, g), g) * pressure / rate).epsilon(1e-12));
    }
}

TEST_CASE("cell viscosity: between its limits, and at them for the stated reasons") {
  CHECK(viscosity(4, 3, 1, medium) == Approx(mu_of_I(2 / std::sqrt(3.), medium) * 3 / 2));
  CHECK(viscosity(0, 3, 1, medium) == limits.eta_max);   // rest under pressure
  CHECK(viscosity(0, 0, 1, medium) == limits.eta_min);   // no pressure: starts to flow
  CHECK(viscosity(4, -3, 1, medium) == limits.eta_min);  // tension bears nothing
  CHECK(viscosity(4, 3, 0, medium) == limits.air);
  CHECK(viscosity(0, 3, 0.25, medium) == Approx(0.25 * limits.eta_max + 0.75 * limits.air));
  const ViscosityLimits raised{1, 1e6, 0.0164, 5};
  CHECK(viscosity(4, -2, 1, medium, raised) == Approx(viscosity(4, 3, 1, medium)));  // background pressure
}

TEST_CASE("several materials: shares take linear means, and air takes no part in them") {
  const std::vector<double> grains{1, 1, 0.5, 0, 1}, first{0, 0.25, 0.25, 0, 0.7},
      second{1, 0.25, 0, 0, 0.3000001};
  const int n = 5;
  std::vector<double> share_1(n), share_2(n), mean(n),
      expected{7, 0.5 * 2 + 0.25 * 3 + 0.25 * 7, 2.5, 2, 3 * 0.7 + 7 * 0.3};
  share_row(first.data(), grains.data(), n, share_1.data());
  share_row(second.data(), grains.data(), n, share_2.data());
  const double* shares[] = {share_1.data(), share_2.data()};
  const double values[] = {2, 3, 7};
  blend_row(values, shares, n, mean.data());
  for (int i = 0; i < n; ++i) CHECK(mean[i] == Approx(expected[i]).epsilon(1e-6));
}

TEST_CASE("viscosity rows: one law by three ways") {
  Noise noise;
  const int n = 40;
  std::vector<double> gamma2(n), p(n), grains(n), I(n), mu(n), g(n), one(n), rows(n), by_mu(n), by_g(n),
      ds(n);
  std::vector<double> mu_s(n, medium.mu_s), delta_mu(n, medium.delta_mu), I_0(n, medium.I_0),
      cohesion(n, 0.3);
  std::fill(ds.begin(), ds.end(), medium.diameter * std::sqrt(medium.density));
  for (int i = 0; i < n; ++i) {
    gamma2[i] = noise.logarithmic(1e-6, 10);
    p[i] = noise(-1, 50);
    grains[i] = i % 5 == 0 ? 0 : i % 3 == 0 ? noise(0, 1) : 1;
  }
  Grain sticky = medium;
  sticky.cohesion = 0.3;
  const GrainRows properties{mu_s.data(), delta_mu.data(), I_0.data(), ds.data(), cohesion.data()};
  granular_viscosity_row(gamma2.data(), p.data(), grains.data(), n, sticky, limits, one.data());
  granular_viscosity_row(gamma2.data(), p.data(), grains.data(), n, properties, limits, rows.data());
  friction_row(gamma2.data(), p.data(), n, properties, limits, I.data(), mu.data());
  viscosity_of_friction_row(gamma2.data(), p.data(), grains.data(), n, mu.data(), cohesion.data(), limits,
                            by_mu.data());
  for (int i = 0; i < n; ++i) g[i] = std::sqrt(gamma2[i]) / mu[i];  // the local fluidity
  viscosity_of_fluidity_row(g.data(), gamma2.data(), p.data(), grains.data(), n, cohesion.data(), limits,
                            by_g.data());
  for (int i = 0; i < n; ++i) {
    CHECK(rows[i] == Approx(one[i]).epsilon(1e-12));
    CHECK(by_mu[i] == Approx(one[i]).epsilon(1e-12));
    CHECK(by_g[i] == Approx(one[i]).epsilon(1e-12));
  }
}

TEST_CASE("cohesion: a yield stress that pressure does not need") {
  Grain sticky = medium;
  sticky.cohesion = 2;
  CHECK(viscosity(4, 0, 1, sticky) == Approx(1));  // cohesion / |γ̇|
  CHECK(viscosity(0.01, 0, 1, sticky) == Approx(20));
  CHECK(viscosity(4, 3, 1, sticky) == Approx(viscosity(4, 3, 1, medium) + 1));
  CHECK(viscosity(0, 0, 1, sticky) == limits.eta_max);
}

TEST_CASE("smooth cap: eta_max at rest, the law far from it, a smooth way between") {
  for (const double rate : {0.0, 1e-6, 1e-4, 1e-2, 1.0}) {
    const double gamma2 = rate * rate, p = 30, mu_s = medium.mu_s;
    double capped = 0;
    smooth_cap_row(&gamma2, &p, &mu_s, 1, limits, &capped);
    const double slowest = medium.mu_s * 30 / limits.eta_max;
    CHECK(capped == Approx(gamma2 + slowest * slowest));
    if (rate == 0) CHECK(viscosity(capped, p, 1, medium) == Approx(limits.eta_max).epsilon(1e-3));
    if (rate == 1)
      CHECK(viscosity(capped, p, 1, medium) == Approx(viscosity(gamma2, p, 1, medium)).epsilon(1e-8));
  }
}

TEST_CASE("corner viscosity: harmonic and arithmetic means, weights of walls, wrapped where periodic") {
  const int nx = 8, ny = 6;
  const Patch p{nx, ny, 1, 0, 0};
  Noise noise;
  CellField eta(p);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) eta(i, j) = noise.logarithmic(1, 1e6);
  for (const auto& [name, b] : all_kinds_of_boundaries(nx, ny))
    for (bool harmonic : {true, false}) {
      INFO(name << (harmonic ? " harmonic" : " arithmetic"));
      CornerField corner(p);
      for (int j = 0; j <= ny; ++j) corner_viscosity_row(eta, b, harmonic, j, corner);
      const auto mean = [&, periodic = b.periodic_x](int i, int j) {
        const auto at = [&](int ii, int jj) {
          ii = periodic ? (ii + nx) % nx : std::clamp(ii, 0, nx - 1);
          return eta(ii, std::clamp(jj, 0, ny - 1));
        };
        const double four[] = {at(i - 1, j - 1), at(i, j - 1), at(i - 1, j), at(i, j)};
        double sum = 0;
        for (double e : four) sum += harmonic ? 1 / e : e;
        return harmonic ? 4 / sum : sum / 4;
      };
      for (int j = 0; j <= ny; ++j)
        for (int i = 0; i <= nx; ++i) {
          const bool side = !b.periodic_x && (i == 0 || i == nx), base = j == 0 || j == ny;
          double weight = 0;
          if (side) weight += (i == 0 ? b.left : b.right).shear[j];
          if (base) weight += (j == 0 ? b.bottom : b.top).shear[i];
          if (side && base) weight /= 2;
          CHECK(corner(i, j) == Approx(mean(i, j) * (side || base ? weight : 1)).epsilon(1e-12));
        }
    }
}

TEST_CASE("well-posedness: C(I) changes sign at the published ends of the range") {
  for (const auto& [grain, first, last] : {std::tuple{low, 0.0623, 1.00},
                                           {smooth_beads, 0.0136, 1.81},
                                           {Grain{0.342, 0.215, 0.069}, 0.00397, 0.280}}) {
    CHECK(well_posedness(0.9 * first, grain) > 0);
    CHECK(well_posedness(1.1 * first, grain) < 0);
    CHECK(well_posedness(0.9 * last, grain) < 0);
    CHECK(well_posedness(1.1 * last, grain) > 0);
  }
  for (double I = 1e-6; I < 1e3; I *= 1.1) CHECK(well_posedness(I, medium) > 0);  // nowhere
}
