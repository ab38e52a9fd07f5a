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
      const double eta =
          granular_viscosity(rate, pressure, g.mu_s, g.delta_mu, g.I_0, g.diameter * std::sqrt(g.density));
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

TEST_CASE("several materials: equal ones are one, and shares take linear means") {
  Noise noise;
  const int n = 40;
  std::vector<double> gamma2(n), p(n), grains(n), tracer(n), one(n), many(n);
  for (int i = 0; i < n; ++i) {
    gamma2[i] = noise.logarithmic(1e-6, 10);
    p[i] = noise(-1, 50);
    grains[i] = i % 5 == 0 ? 0 : i % 3 == 0 ? noise(0, 1) : 1;
    tracer[i] = grains[i] * noise(0, 1);
  }
  granular_viscosity_row(gamma2.data(), p.data(), grains.data(), n, medium, limits, one.data());
  blended_viscosity_row(gamma2.data(), p.data(), grains.data(), {tracer.data()}, n, {medium, medium}, limits,
                        many.data());
  for (int i = 0; i < n; ++i) CHECK(many[i] == Approx(one[i]).epsilon(1e-12));

  const double rate2 = 0.25, pressure = 7, full = 1, third = 1.0 / 3;
  double blended = 0;
  blended_viscosity_row(&rate2, &pressure, &full, {&third}, 1, {medium, low}, limits, &blended);
  const Grain mean{(2 * 0.62 + 0.47) / 3, (2 * 0.48 + 0.38) / 3, 0.6, 1, 1};
  CHECK(blended == Approx(viscosity(rate2, pressure, 1, mean)).epsilon(1e-12));
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
      const auto mean = [&](int i, int j) {
        const auto at = [&](int ii, int jj) {
          ii = b.periodic_x ? (ii + nx) % nx : std::clamp(ii, 0, nx - 1);
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
