// Half domains, round silos, and orifices whose ends lie within faces.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "solver/boundary_of.hpp"
#include "solver/diagnostics.hpp"
#include "solver/geometry.hpp"
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"
#include "tests/support/same_bits.hpp"

using namespace hourglass;

namespace {

/// A silo with a tracer layer, solved tightly.
Scene tight_silo(int cells) {
  Scene s = silo(cells);
  s.materials.push_back(s.materials[0]);
  s.materials[1].name = "tracer";
  s.fill.push_back(fill_box(1, 0, 150, 0, 40));
  s.accuracy.viscous_tolerance = 1e-6;
  s.accuracy.pressure_tolerance = 1e-9;
  s.accuracy.precision = Precision::full;
  return s;
}

/// The right half of a scene that is its own mirror image.
Scene half_of_scene(Scene s) {
  const double middle = 0.5 * s.width;
  s.symmetry = Symmetry::mirror;
  s.walls[0] = Wall::free_slip;
  s.width = middle;
  s.cells_x /= 2;
  for (Orifice& o : s.orifices) o.centre -= middle;
  for (Insert& insert : s.inserts) insert.centre[0] -= middle;
  for (Fill& f : s.fill)
    for (auto& corner : f.points) corner[0] = std::max(corner[0] - middle, 0.0);
  return s;
}

void expect_same(const char* what, const Scene& whole, int steps) {
  Simulation a(whole), b(half_of_scene(whole));
  const double mass = a.grain_mass();
  CHECK(b.grain_mass() == Approx(mass).epsilon(1e-12));
  for (int n = 0; n < steps; ++n) {
    a.step();
    b.step();
  }
  const double left = std::abs(a.grain_mass() - b.grain_mass()) / mass;
  const double out = std::abs(a.orifice_mass()[0] - b.orifice_mass()[0]) / a.orifice_mass()[0];
  const double tracer = std::abs(a.material_mass()[1] - b.material_mass()[1]) / mass;
  double closed = 0;
  for (const Simulation* s : {&a, &b})
    closed = std::max(closed, std::abs(mass - s->grain_mass() - s->orifice_mass()[0]) / mass);
  figure(
      "half domain, %s, %d steps: mass left differs by %.1e, outflow %.1e, tracer %.1e; t by %.1e; account "
      "%.1e",
      what, steps, left, out, tracer, std::abs(a.t() - b.t()), closed);
  INFO(what << ": left " << left << ", out " << out << ", tracer " << tracer);
  CHECK(left < 1e-6);
  CHECK(out < 1e-4);
  CHECK(tracer < 1e-6);
  CHECK(a.orifice_mass()[0] > 0.001 * mass);
}

}  // namespace

TEST_CASE("half of a mirrored silo flows like the whole") {
  const Scene plain = tight_silo(64);
  expect_same("plain", plain, 100);
  for (const Shape shape : {Shape::diamond, Shape::circle}) {
    Scene s = plain;
    s.inserts = {insert_of(shape, 75, 56.25, 37.5, 37.5)};
    expect_same(shape_names[static_cast<int>(shape)], s, 100);
  }
  Scene s = plain;
  s.hopper = Hopper{30, 18.75};
  expect_same("hopper", s, 100);
}

TEST_CASE("half of a mirrored silo flows like the whole, with every module") {
  Scene plain = tight_silo(64);
  plain.inserts = {insert_of(Shape::circle, 75, 56.25, 37.5, 37.5)};
  Scene s = plain;
  s.nonlocal = Nonlocal{};
  s.accuracy.fluidity_tolerance = 1e-8;
  expect_same("nonlocal", s, 60);
  s = plain;
  s.dilatancy = Dilatancy{};
  expect_same("dilatancy", s, 60);
  s = plain;
  s.wall_friction = WallFriction{};
  s.wall_friction->F = 0.01;
  expect_same("wall friction", s, 60);
}

TEST_CASE("pipe flow around an axis: second order") {
  std::vector<double> errors;
  for (int n : {8, 16}) {
    Scene s = newtonian(1, 6, n, {1});
    s.coordinates = Coordinates::axisymmetric;
    s.walls = {Wall::free_slip, Wall::no_slip, Wall::open, Wall::open};
    s.gravity = {0, -1e-3};
    s.air = {1, 1};
    s.accuracy.viscous_tolerance = 1e-9;
    s.time.dt_max = 0.2;
    Simulation simulation(s);
    run_to_steady(simulation, 1e-9, 300);
    const Fields& f = simulation.fields();
    const int j = 3 * n, q = n / 4;  // the middle of the height; open ends change the pressure
    const double drive = 1e-3 + (f.p(n / 2, j + q) - f.p(n / 2, j - q)) / (2 * q * f.patch().h);
    double error = 0, weight = 0;
    for (int i = 0; i < n; ++i) {
      const double r = f.patch().x_centre(i);
      error += r * std::abs(-f.v(i, j) - drive * (1 - r * r) / 4);
      weight += r;
    }
    errors.push_back(error / weight / (drive / 4));
  }
  figure("pipe: L1 %s orders %s", listed(errors).c_str(), listed(orders(errors)).c_str());
  expect_order(errors, 2.0, 0.1);
}

TEST_CASE("a round tank at rest stays at rest, with and without solids") {
  const std::vector<std::vector<Insert>> all{{},
                                             {insert_of(Shape::circle, 0, 50.3, 40, 40)},
                                             {insert_of(Shape::diamond, 40.7, 50.3, 30, 30)},
                                             {insert_of(Shape::rectangle, 30, 77.7, 21, 60)}};
  for (const auto& inserts : all) {
    Scene s = silo(32);
    s.coordinates = Coordinates::axisymmetric;
    s.walls[0] = Wall::free_slip;
    s.width = 75;
    s.cells_x = 32;
    s.orifices.clear();
    s.fill = {fill_box(0, 0, 75, 0, 101.3)};
    s.inserts = inserts;
    s.start_pressure = StartPressure::hydrostatic;
    s.accuracy.precision = Precision::full;
    Simulation simulation(s);
    for (int n = 0; n < 20; ++n) simulation.step();
    double speed = 0;
    const Fields& f = simulation.fields();
    for (int j = 0; j < f.p.ny(); ++j)
      for (int i = 0; i < f.p.nx(); ++i) speed = std::max({speed, std::abs(f.u(i, j)), std::abs(f.v(i, j))});
    figure("round tank, %d solids: speed %.1e", static_cast<int>(inserts.size()), speed);
    CHECK(speed < 1e-11);
  }
}

TEST_CASE("a round silo keeps account of its grains") {
  for (const bool with_insert : {false, true}) {
    Scene s = silo(32);
    s.coordinates = Coordinates::axisymmetric;
    s.walls[0] = Wall::free_slip;
    s.width = 75;
    s.orifices[0].centre = 0;
    s.orifices[0].width = 30;
    s.fill = {fill_box(0, 0, 75, 0, 100), fill_box(1, 0, 75, 30, 60)};
    s.materials.push_back(s.materials[0]);
    s.materials[1].name = "tracer";
    if (with_insert) s.inserts = {insert_of(Shape::diamond, 0, 50, 40, 40)};
    Simulation simulation(s);
    const double before = simulation.grain_mass();
    if (!with_insert) {
      CHECK(before == Approx(M_PI * 75 * 75 * 100).epsilon(1e-10));
      CHECK(simulation.material_mass()[1] == Approx(M_PI * 75 * 75 * 30).epsilon(1e-10));
    } else {  // two cones of radius 20 and height 20
      CHECK(before == Approx(M_PI * (75 * 75 * 100 - 2.0 / 3 * 20 * 20 * 20)).epsilon(1e-2));
    }
    while (simulation.grain_mass() > 0.5 * before && simulation.t() < 80) simulation.step();
    const double error = std::abs(before - simulation.grain_mass() - simulation.orifice_mass()[0]) / before;
    const double out = simulation.orifice_mass()[0] / before;
    figure("round silo%s: %.3f out at t = %.1f, mass error %.1e", with_insert ? " with a diamond" : "", out,
           simulation.t(), error);
    CHECK(error < 1e-6);
    CHECK(out > 0.1);
  }
}

namespace {

double discharge_of(const Scene& scene, double end) {
  Simulation simulation(scene);
  std::vector<std::array<double, 2>> history;
  while (simulation.t() < end) {
    simulation.step(end);
    history.push_back({simulation.t(), simulation.grain_mass()});
  }
  return discharge(scene, history).rate / code_unit;
}

}  // namespace

TEST_CASE("the discharge changes little as an orifice moves by fractions of a cell", "[slow]") {
  const double h = 150.0 / 64;
  std::vector<double> rates;
  for (double shift : {0.0, 0.1, 0.25, 0.5, 0.75, 1.0})
    rates.push_back(discharge_of(silo(64, 16, 75 + shift * h, 8 * h), 16));
  const auto [low, high] = std::minmax_element(rates.begin(), rates.end());
  figure("orifice moved by fractions of a cell: %s, spread %.2f %%", listed(rates).c_str(),
         100 * (*high / *low - 1));
  INFO(listed(rates));
  CHECK(*high / *low < 1.06);
  for (std::size_t k = 1; k < rates.size(); ++k) CHECK(rates[k] == Approx(rates[k - 1]).epsilon(0.035));
  CHECK(rates.back() == Approx(rates.front()).epsilon(1e-3));

  std::vector<double> widths;
  for (double wider : {0.0, 0.5, 1.0})
    widths.push_back(discharge_of(silo(64, 16, 75 + 0.5 * wider * h, (8 + wider) * h), 16));
  figure("orifice of 8 to 9 cells: %s", listed(widths).c_str());
  CHECK(std::is_sorted(widths.begin(), widths.end()));
}

TEST_CASE("two orifices that share a face let out what one does in their place") {
  const double h = 150.0 / 64;
  Scene one = silo(64), two = one;
  one.orifices = {{Side::bottom, 75, 9 * h}};
  const double from = 75 - 4.5 * h;
  two.orifices = {{Side::bottom, from + 1.65 * h, 3.3 * h}, {Side::bottom, from + 6.15 * h, 5.7 * h}};
  Simulation a(one), b(two);
  const double mass = a.grain_mass();
  for (int n = 0; n < 150; ++n) {
    a.step();
    b.step();
  }
  const double sum = b.orifice_mass()[0] + b.orifice_mass()[1];
  figure("two orifices that share a face: %.6g + %.6g, one: %.6g; account %.1e", b.orifice_mass()[0],
         b.orifice_mass()[1], a.orifice_mass()[0], std::abs(mass - b.grain_mass() - sum) / mass);
  CHECK(sum == Approx(a.orifice_mass()[0]).epsilon(1e-6));
  CHECK(mass - b.grain_mass() == Approx(sum).epsilon(1e-6));
  CHECK(b.orifice_mass()[0] / sum == Approx(3.3 / 9).margin(0.05));
}

TEST_CASE("solids, an axis, no air, a feed: one thread and two give the same bits", "[slow]") {
  Scene scene = silo(64, 0);
  scene.inserts = {{Shape::circle, {75, 56.25}, 37.5, 37.5, {}}, {Shape::diamond, {30, 40}, 20, 20, {}}};
  scene.time.max_steps = 60;
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].name = "above";
  scene.fill.push_back(fill_box(1, 0, 150, 60, 100));
  for (const int variant : {0, 1, 2, 3}) {
    Scene s = scene;
    if (variant == 1) {
      s.coordinates = Coordinates::axisymmetric;
      s.width = 75;
      s.cells_x = 32;
      s.orifices[0].centre = 0;
      s.inserts = {{Shape::circle, {0, 56.25}, 37.5, 37.5, {}}};
    }
    if (variant == 2) s.air.model = AirModel::none;
    if (variant == 3) s.feed = Feed{1, 135};
    Simulation one(s);
    s.threads = 2;
    Simulation two(s);
    one.run();
    two.run();
    INFO("variant " << variant);
    CHECK(same_bits(one.fields().u, two.fields().u));
    CHECK(same_bits(one.fields().v, two.fields().v));
    CHECK(same_bits(one.fields().p, two.fields().p));
    CHECK(same_bits(one.fields().grains, two.fields().grains));
    CHECK(same_bits(one.fields().tracers[0], two.fields().tracers[0]));
  }
}
