// Solids that cut cells: order of channel flows and of the flow past a cylinder, rest, equivalent shapes, conservation.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "solver/boundary_of.hpp"
#include "solver/diagnostics.hpp"
#include "solver/geometry.hpp"
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

/// A channel through the unit square between two polygons, gravity 1 along it, both ends open.
struct Channel {
  double width, angle;                           // [degrees]
  std::array<double, 2> middle{0.5123, 0.4929};  // on no grid line
  double tx = std::cos(angle * M_PI / 180), ty = std::sin(angle * M_PI / 180);

  std::array<double, 2> at(double along, double across) const {
    return {middle[0] + along * tx - across * ty, middle[1] + along * ty + across * tx};
  }
  Scene scene(int cells) const {
    Scene s = newtonian(1, 1, cells, {1});
    for (int side : {-1, 1}) {
      const double wall = 0.5 * side * width, far = 3 * side;
      s.inserts.push_back(insert_of({at(-3, wall), at(3, wall), at(3, far), at(-3, far)}));
    }
    s.gravity = {tx, ty};
    s.walls = {Wall::open, Wall::open, Wall::open, Wall::open};
    s.air = {1, 1};
    s.accuracy.viscous_tolerance = 1e-9;
    s.accuracy.pressure_tolerance = 1e-10;
    s.accuracy.max_iterations = 500;
    s.time.dt_max = 0.1 * width * width;
    return s;
  }
};

double interpolated(const CellField& f, const std::array<double, 2>& at) {
  const Patch& p = f.patch();
  const double x = (at[0] - p.x0) / p.h - 0.5, y = (at[1] - p.y0) / p.h - 0.5;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const double a = x - i, b = y - j;
  return (1 - b) * ((1 - a) * f(i, j) + a * f(i + 1, j)) + b * ((1 - a) * f(i, j + 1) + a * f(i + 1, j + 1));
}

struct ChannelErrors {
  double l1, largest;  // of the velocity along x in the middle of the channel, over the fastest
};

/// Slanted open ends change the pressure: what drives is measured in the middle.
ChannelErrors error_of(const Channel& channel, int cells, SolidModel model = SolidModel::cut_cells) {
  Scene s = channel.scene(cells);
  s.accuracy.solids = model;
  Simulation simulation(s);
  for (int n = 0; n < 40; ++n) simulation.step();
  const Fields& f = simulation.fields();
  const auto geometry = geometry_of(s, boundary_of(s));
  const double w = channel.width;
  const auto mean_pressure = [&](double along) {
    double sum = 0;
    for (int k = -15; k <= 15; ++k) sum += interpolated(f.p, channel.at(along, 0.02 * k * w));
    return sum / 31;
  };
  const double drive = 1 - (mean_pressure(0.1) - mean_pressure(-0.1)) / 0.2;
  const double fastest = drive * w * w / 8 * channel.tx;
  double sum = 0, largest = 0;
  int n = 0;
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const double x = f.patch().x_corner(i) - channel.middle[0],
                   y = f.patch().y_centre(j) - channel.middle[1];
      const double along = x * channel.tx + y * channel.ty, across = y * channel.tx - x * channel.ty;
      if (std::abs(along) > 0.05 || geometry->aperture.u(i, j) == 0) continue;
      // the mean over the open part of the face
      const double reach = 0.5 * f.patch().h * channel.tx;
      const double low = std::max(across - reach, -0.5 * w), high = std::min(across + reach, 0.5 * w);
      const double square = (low * low + low * high + high * high) / 3;
      const double exact = 0.5 * drive * (0.25 * w * w - square) * channel.tx;
      const double error = std::abs(f.u(i, j) - exact) / fastest;
      sum += error;
      largest = std::max(largest, error);
      ++n;
    }
  return {sum / n, largest};
}

/// The mean over four places of the channel: a wall at 45 degrees cuts all its cells alike, well or badly.
ChannelErrors mean_error_of(Channel channel, int cells, SolidModel model = SolidModel::cut_cells) {
  ChannelErrors mean{0, 0};
  for (int k = 0; k < 4; ++k) {
    channel.middle[1] += 0.0029;
    const ChannelErrors e = error_of(channel, cells, model);
    mean.l1 += 0.25 * e.l1;
    mean.largest = std::max(mean.largest, e.largest);
  }
  return mean;
}

double mean_order(const std::vector<double>& errors) {
  return std::log2(errors.front() / errors.back()) / (static_cast<double>(errors.size()) - 1);
}

}  // namespace

TEST_CASE("channel flow between walls within cells: second order, periodic") {
  // The walls cut the cells at the same share on every grid, and at any.
  for (const double share : {0.1, 0.5, 0.75}) {
    std::vector<double> errors, stairs;
    for (int n : {16, 32, 64})
      for (const SolidModel model : {SolidModel::cut_cells, SolidModel::staircase}) {
        const double h = 1.0 / n, low = 0.25 - share * h, high = 0.75 + share * h;
        Scene s = newtonian(4 * h, 1, 4, {1});
        s.walls[0] = s.walls[1] = Wall::periodic;
        s.walls[3] = Wall::no_slip;
        s.gravity = {1e-3, 0};
        s.inserts = {insert_of({{-1, -1}, {2, -1}, {2, low}, {-1, low}}),
                     insert_of({{-1, high}, {2, high}, {2, 2}, {-1, 2}})};
        s.accuracy.solids = model;
        Simulation simulation(s);
        run_to_steady(simulation, 1e-11, 100);
        double error = 0;
        for (int j = n / 4; j < n - n / 4; ++j) {  // whole cells: u at their middle
          const double y = (j + 0.5) * h;
          error += std::abs(simulation.fields().u(1, j) - 0.5e-3 * (y - low) * (high - y));
        }
        const double w = high - low;
        (model == SolidModel::cut_cells ? errors : stairs).push_back(error / (0.5 * n) / (1e-3 * w * w / 8));
      }
    figure("channel of walls with %.2f of a cell open: %s orders %s; staircase %s", share,
           listed(errors).c_str(), listed(orders(errors)).c_str(), listed(stairs).c_str());
    INFO("open share of cut cells " << share);
    expect_order(errors, 2.0, 0.2);
    CHECK(stairs.back() > 3 * errors.back());
  }
}

TEST_CASE("channel flow between inclined walls: second order, and better than steps") {
  for (const double angle : {20.0, 45.0}) {
    const Channel channel{0.24, angle};
    std::vector<double> l1, largest;
    for (int n : {32, 64}) {
      const ChannelErrors e = mean_error_of(channel, n);
      l1.push_back(e.l1);
      largest.push_back(e.largest);
    }
    const ChannelErrors steps = mean_error_of(channel, 64, SolidModel::staircase);
    figure("channel at %.0f degrees: L1 %s orders %s; largest %s; staircase at 64: L1 %.2e, largest %.2e",
           angle, listed(l1).c_str(), listed(orders(l1)).c_str(), listed(largest).c_str(), steps.l1,
           steps.largest);
    INFO(angle << " degrees: " << listed(l1) << ", staircase " << steps.l1);
    CHECK(mean_order(l1) > 1.7);
    CHECK(steps.l1 > 5 * l1.back());
  }
}

TEST_CASE("channel flow between inclined walls: second order up to 256^2", "[slow]") {
  for (const double angle : {20.0, 45.0}) {
    std::vector<double> l1, largest, steps;
    for (int n : {32, 64, 128, 256}) {
      const ChannelErrors e = mean_error_of({0.12, angle}, n);
      l1.push_back(e.l1);
      largest.push_back(e.largest);
      if (n < 256) steps.push_back(mean_error_of({0.12, angle}, n, SolidModel::staircase).l1);
    }
    figure("narrow channel at %.0f degrees: L1 %s orders %s; largest %s orders %s; staircase L1 %s", angle,
           listed(l1).c_str(), listed(orders(l1)).c_str(), listed(largest).c_str(),
           listed(orders(largest)).c_str(), listed(steps).c_str());
    INFO(angle << " degrees: " << listed(l1) << ", " << listed(largest));
    CHECK(mean_order(l1) > 1.8);
    CHECK(mean_order(largest) > 1.8);
    CHECK(steps.back() > 10 * l1[2]);
  }
}

namespace {

/// Slow flow past a cylinder in a periodic channel, driven along it; the centre is on no grid line.
struct PastCylinder {
  double rate;
  Velocity velocity, aperture;
};
PastCylinder past_cylinder(int cells, SolidModel model = SolidModel::cut_cells) {
  Scene s = newtonian(1, 1, cells, {1});
  s.gravity = {1e-3, 0};
  s.walls = {Wall::periodic, Wall::periodic, Wall::no_slip, Wall::no_slip};
  s.inserts = {insert_of(Shape::circle, 0.487, 0.513, 0.4, 0.4)};
  s.accuracy.solids = model;
  s.accuracy.viscous_tolerance = 1e-8;
  s.time.dt_max = 0.1;
  Simulation simulation(s);
  run_to_steady(simulation, 1e-7, 100);
  const Fields& f = simulation.fields();
  const auto geometry = geometry_of(s, boundary_of(s));
  double rate = 0;
  for (int j = 0; j < cells; ++j) rate += f.u(0, j) / cells;
  return {rate, f, geometry->aperture};
}

/// L1 distance of u over all faces to the means of a finer grid, weighted by what is open, over the mean of u.
double distance_to(const PastCylinder& finest, const PastCylinder& coarse) {
  const XFaceField &u = coarse.velocity.u, &fine = finest.velocity.u;
  const int times = fine.ny() / u.ny();
  double sum = 0, size = 0;
  for (int j = 0; j < u.ny(); ++j)
    for (int i = 0; i < u.ny(); ++i) {
      double flux = 0;
      for (int k = 0; k < times; ++k)
        flux += finest.aperture.u(times * i, times * j + k) * fine(times * i, times * j + k);
      sum += std::abs(coarse.aperture.u(i, j) * u(i, j) - flux / times);
      size += std::abs(flux / times);
    }
  return sum / size;
}

void past_cylinder_study(const std::vector<int>& grids, int finest_grid) {
  const PastCylinder finest = past_cylinder(finest_grid);
  std::vector<double> rates, velocities, stairs;
  for (int n : grids) {
    const PastCylinder now = past_cylinder(n);
    rates.push_back(std::abs(now.rate / finest.rate - 1));
    velocities.push_back(distance_to(finest, now));
    const PastCylinder steps = past_cylinder(n, SolidModel::staircase);
    stairs.push_back(distance_to(finest, steps));
  }
  figure(
      "past a cylinder, against %d^2 (rate %.6g): rate %s orders %s; velocity, L1 %s orders %s; staircase, "
      "velocity %s",
      finest_grid, finest.rate, listed(rates).c_str(), listed(orders(rates)).c_str(),
      listed(velocities).c_str(), listed(orders(velocities)).c_str(), listed(stairs).c_str());
  INFO("rate " << listed(rates) << ", velocity " << listed(velocities) << ", staircase " << listed(stairs));
  CHECK(mean_order(rates) > 1.8);
  CHECK(mean_order(velocities) > 1.8);
  CHECK(stairs.back() > velocities.back());
}

struct Named {
  const char* name;
  std::vector<Insert> inserts;
};
/// Every shape off the grid, in a domain of 150 x 150.
std::vector<Named> all_shapes() {
  const double x = 72.3, y = 61.7, w = 37.5;
  const Insert circle = insert_of(Shape::circle, 60, y, w, w);
  return {{"square", {insert_of(Shape::square, x, y, w, w)}},
          {"rectangle", {insert_of(Shape::rectangle, x, y, w, 20.1)}},
          {"diamond", {insert_of(Shape::diamond, x, y, w, w)}},
          {"triangle_up", {insert_of(Shape::triangle_up, x, y, w, w)}},
          {"triangle_down", {insert_of(Shape::triangle_down, x, y, w, w)}},
          {"circle", {insert_of(Shape::circle, x, y, w, w)}},
          {"polygon", {insert_of({{50, 45}, {95, 52}, {70, 60}, {88, 85}, {55, 78}})}},
          {"overlapping", {circle, insert_of(Shape::diamond, 80, y + 5, w, w)}}};
}

}  // namespace

TEST_CASE("flow past a cylinder converges with second order in the mean") {
  past_cylinder_study({16, 32}, 64);
}

TEST_CASE("flow past a cylinder converges with second order in the mean, up to 256^2", "[slow]") {
  past_cylinder_study({16, 32, 64}, 256);
}

TEST_CASE("a tank with a solid in it stays at rest: to rounding, but for a surface that meets a slope") {
  for (const Named& shape : all_shapes())
    for (const bool newtonian_fluid : {false, true})
      for (const double level : {62.3, 110.0}) {  // through the solid, above it
        Scene s = silo(32);
        s.orifices.clear();
        if (newtonian_fluid) {
          s.rheology.law = Law::newtonian;
          s.materials[0].viscosity = 10;
          s.walls[3] = Wall::no_slip;
        }
        s.fill = {fill_box(0, 0, 150, 0, level)};
        s.inserts = shape.inserts;
        s.start_pressure = StartPressure::hydrostatic;
        s.accuracy.precision = Precision::full;
        Simulation simulation(s);
        // A level surface leaves cells that a slope cuts another share of grains than those beside them, and with it another
        // density: the air there is pushed, the grains creep.
        const bool upright = shape.name == std::string("square") || shape.name == std::string("rectangle");
        const bool to_rounding = upright || level > 100;
        bool converged = true;
        for (int n = 0; n < (to_rounding ? 20 : 200); ++n) {
          const StepReport report = simulation.step();
          converged = converged && report.viscous.converged && report.pressure.converged;
        }
        const double speed = fastest(simulation.fields());
        const double grains = fastest_grains(simulation.fields(), nullptr, 1);
        figure("rest around %s, %s, level %.1f: %.1e, grains %.1e", shape.name,
               newtonian_fluid ? "closed, newtonian" : "open, grains", level, speed, grains);
        INFO(shape.name << (newtonian_fluid ? ", newtonian" : ", grains") << ", level " << level);
        CHECK(converged);
        if (to_rounding) {
          CHECK(speed < 1e-11);
        } else {
          CHECK(grains < (newtonian_fluid ? 0.1 : 2e-5));
        }
      }
}

namespace {

/// Adds up what leaves, by material, and the work of the solvers.
class Account : public Observer {
 public:
  std::vector<double> out{0, 0};
  long steps = 0, viscous = 0, pressure = 0;
  void on_series(const SeriesRow& row) override {
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += row.material_outflow[k] * (row.step.t - last_);
    last_ = row.step.t;
  }
  void on_step(const StepReport& report, double) override {
    ++steps;
    viscous += report.viscous.iterations;
    pressure += report.pressure.iterations;
  }

 private:
  double last_ = 0;
};

struct Drained {
  Summary summary;
  double mass_error = 0, tracer_error = 0, left = 0;  // shares of their mass at the start
  double iterations = 0;                              // of both solves, a step
  double rate() const { return summary.discharge_rate / code_unit; }
};

/// A silo with a tracer layer, until `end` or until a quarter is left.
Drained drain(int cells, const std::vector<Insert>& inserts, double end) {
  Scene s = silo(cells, end);
  s.materials.push_back(s.materials[0]);
  s.materials[1].name = "tracer";
  s.fill.push_back(fill_box(1, 0, 150, 60, 90));
  s.inserts = inserts;
  s.stop.mass_below = 0.25;
  s.output.series_every = 5;
  Simulation simulation(s);
  const double mass = simulation.grain_mass(), tracer = simulation.material_mass()[1];
  Account account;
  Drained d;
  d.summary = simulation.run({&account});
  d.mass_error = std::abs(mass - simulation.grain_mass() - simulation.orifice_mass()[0]) / mass;
  d.tracer_error = std::abs(tracer - simulation.material_mass()[1] - account.out[1]) / tracer;
  d.left = simulation.grain_mass() / mass;
  d.iterations = static_cast<double>(account.viscous + account.pressure) / static_cast<double>(account.steps);
  return d;
}

void expect_account(const char* name, int cells, const Drained& d) {
  figure(
      "drain %d^2, %s: %.3f left at the end, rate %.4f, static %.4f, errors of mass %.1e, tracer %.1e; %.2f "
      "iterations",
      cells, name, d.left, d.rate(), d.summary.quasi_static_fraction, d.mass_error, d.tracer_error,
      d.iterations);
  INFO(name);
  CHECK(d.mass_error < 1e-6);
  CHECK(d.tracer_error < 1e-6);
  CHECK(d.summary.missed_tolerances == 0);
}

}  // namespace

TEST_CASE("a square turned by 45 degrees is the diamond") {
  const double x = 75, y = 56.25, a = 18.75;
  const Insert diamond = insert_of(Shape::diamond, x, y, 2 * a, 2 * a);
  const Insert same = insert_of({{x, y - a}, {x + a, y}, {x, y + a}, {x - a, y}});
  const double side = a * std::sqrt(2.0), c = std::cos(M_PI / 4), d = std::sin(M_PI / 4);
  std::vector<std::array<double, 2>> corners;
  for (const auto& [p, q] : {std::array{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
    corners.push_back({x + side * (c * p - d * q), y + side * (d * p + c * q)});
  const double of_diamond = drain(64, {diamond}, 16).rate(), of_same = drain(64, {same}, 16).rate(),
               turned = drain(64, {insert_of(corners)}, 16).rate();
  figure("diamond %.9g, polygon %.9g, turned square %.9g", of_diamond, of_same, turned);
  CHECK(of_same == of_diamond);
  CHECK(turned == Approx(of_diamond).epsilon(1e-6));
}

TEST_CASE("between polygons that make a hopper no grain is lost, and they are the hopper") {
  const double rise = 50;
  const std::vector<Insert> walls{insert_of({{0, 0}, {65.625, 0}, {0, rise}}),
                                  insert_of({{84.375, 0}, {150, 0}, {150, rise}})};
  const Drained d = drain(64, walls, 16);
  expect_account("two polygons", 64, d);
  Scene s = silo(64, 16);
  s.hopper = Hopper{std::atan(65.625 / rise) * 180 / M_PI, 18.75};
  CHECK(Simulation(s).run().discharge_rate == Approx(d.summary.discharge_rate).epsilon(1e-6));
}

TEST_CASE("whole drains around every shape keep account of grains and tracer", "[slow]") {
  const Drained plain = drain(64, {}, 200);
  expect_account("nothing", 64, plain);
  for (const Named& shape : all_shapes()) expect_account(shape.name, 64, drain(64, shape.inserts, 200));
}

TEST_CASE("drains at 128^2: account, iterations, and where grains stand still", "[slow]") {
  const Drained plain = drain(128, {}, 27.386);
  expect_account("nothing", 128, plain);
  for (const Shape shape : {Shape::square, Shape::diamond, Shape::triangle_up, Shape::circle}) {
    const Drained d = drain(128, {insert_of(shape, 75, 56.25, 37.5, 37.5)}, 27.386);
    expect_account(shape_names[static_cast<int>(shape)], 128, d);
    CHECK(d.iterations < 1.5 * plain.iterations);
    CHECK(d.summary.quasi_static_fraction < plain.summary.quasi_static_fraction);
  }
}
