#pragma once
// Every key of a scene, once, with what it is: what reads and writes scene files (io), what checks ranges
// (check_ranges.cpp) and the reference in docs/scene.md (io/key_table) all walk this table.
#include <array>
#include <initializer_list>

#include "solver/range.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// What dimensional defaults are multiples of: a member of Scales, and its words.
struct Multiple {
  double Scales::*scale;
  const char* words;
};
inline constexpr Multiple of_length{&Scales::length, "d"};
inline constexpr Multiple of_time{&Scales::time, "sqrt(d/g)"};
inline constexpr Multiple of_density{&Scales::density, "rho"};
inline constexpr Multiple of_viscosity{&Scales::viscosity, "rho sqrt(g d^3)"};
inline constexpr Multiple of_speed{&Scales::speed, "sqrt(g d)"};

/// What is said of a key. Its default is the one in solver/scene.hpp.
struct Key {
  const char* unit = "";  ///< of L, T and M; "1": a pure number; "": a count, a word, a text
  Range range{};
  const char* meaning = "";            ///< a line of Markdown for docs/scene.md
  const char* cure = "";               ///< follows the range in messages
  const char* missing = nullptr;       ///< what the value is, for a key that must be given
  const char* default_text = nullptr;  ///< where the default is not a value, or another one
  const Multiple* multiple = nullptr;  ///< what the default is to be multiplied by

  constexpr Key(const char* meaning_) : meaning(meaning_) {}
  constexpr Key(const char* unit_, Range range_, const char* meaning_, const char* cure_ = "")
      : unit(unit_), range(range_), meaning(meaning_), cure(cure_) {}
  constexpr Key required(const char* text) const { return Key(*this).set(&Key::missing, text); }
  constexpr Key by_default(const char* text) const { return Key(*this).set(&Key::default_text, text); }
  constexpr Key times(const Multiple& what) const { return Key(*this).set(&Key::multiple, &what); }

 private:
  template <class T>
  constexpr Key set(T Key::*member, T value) {
    this->*member = value;
    return *this;
  }
};

/// A visitor that goes to every key the scene has, and leaves it alone. Others inherit what is nothing to them.
struct KeyVisitor {
  void text(auto&&...) {}
  void texts(auto&&...) {}
  void number(auto&&...) {}
  void integer(auto&&...) {}
  void integer_or(auto&&...) {}
  void pair(auto&&...) {}
  void points(auto&&...) {}
  void material(auto&&...) {}
  void shape(auto&&...) {}
  void preset(auto&&...) {}
  void skip(std::initializer_list<const char*>) {}
  void foreign(std::initializer_list<const char*>) {}
  bool choice(auto&&...) { return true; }
  bool word(auto&&...) { return false; }
  bool has(const char*) { return false; }
  void map(const char*, auto&& body) { body(); }
  void module(const char*, auto& value, auto&& body) {
    if (value) body(*value);
  }
  void list(const char*, auto& values, const char*, auto&& body) {
    for (auto& value : values) body(value);
  }
  void named(const char* key, auto& values, const char* required, auto&& body) {
    list(key, values, required, body);
  }
};

/// What the words of `accuracy` stand for. The Courant number is a matter of the scene, not of these.
inline constexpr std::array accuracy_names{"fast", "balanced", "accurate"};
inline constexpr std::array<Accuracy, 3> accuracy_presets{
    Accuracy{.viscous_tolerance = 5e-3,
             .pressure_tolerance = 1e-5,
             .fluidity_tolerance = 3e-2,
             .cells_across_orifice = 6},
    Accuracy{.viscous_tolerance = 1e-3,
             .pressure_tolerance = 3e-6,
             .fluidity_tolerance = 1e-2,
             .cells_across_orifice = 16},
    Accuracy{.viscous_tolerance = 1e-4,
             .pressure_tolerance = 1e-8,
             .fluidity_tolerance = 1e-3,
             .cells_across_orifice = 32,
             .extrapolate = 2},
};

/// Which keys place and size an insert depends on its shape.
template <class Visitor>
void visit_measures(Visitor& v, Insert& i) {
  if (i.shape == Shape::polygon) {
    v.points("points", i.points,
             Key("L", noted("3 to 1000 corners in order"),
                 "of a polygon; it need not be convex, but must not cross itself"));
    v.foreign({"centre", "width", "height", "diameter"});
    return;
  }
  v.pair("centre", i.centre,
         Key("L", noted("two numbers"), "middle of the bounding box; not of a polygon")
             .required("its middle, e.g. [75, 56.25]"));
  if (i.shape == Shape::circle) {
    v.number(v.has("width") && !v.has("diameter") ? "width" : "diameter", i.width,
             Key("L", above(0).also(">= 2 cells"), "of a circle; `width` is another word for it")
                 .required("above 0"));
    i.height = i.width;
    v.foreign({"width", "height", "points"});
    return;
  }
  v.number("width", i.width,
           Key("L", above(0).also(">= 2 cells across"), "of the bounding box; not of a polygon")
               .required("from its left to its right end, above 0"));
  if (i.shape == Shape::square) i.height = i.width;
  if (i.shape != Shape::square || v.has("height"))
    v.number("height", i.height,
             Key("L", above(0).also(">= 2 cells across"),
                 "of the bounding box; not of a circle or a polygon; a square's, if given, is its width")
                 .required("from its lower to its upper end, above 0"));
  v.foreign({"diameter", "points"});
}

/// Of each key its name, where it is kept, unit, range, meaning, and the cure for a value out of range.
template <class Visitor>
void visit_scene(Visitor& v, Scene& s) {
  v.text("name", s.name,
         Key("", noted("1 to 100 characters, no `/`"), "names the run folder").by_default("the file's name"));
  v.choice("units", s.units, units_names, "see above");
  const bool si =
      s.units == Units::SI;  // whose defaults would be metres and kilograms of nothing in particular
  v.map("domain", [&] {
    v.number("width", s.width,
             Key("L", above(0), "of the domain, from x = 0 on").required("the width of the domain, above 0"));
    v.number("height", s.height,
             Key("L", above(0).also("a whole number of cells"), "of the domain, from y = 0 on")
                 .required("the height of the domain, above 0"));
    v.choice("symmetry", s.symmetry, symmetry_names,
             "mirror: the left edge is a mirror plane; see \"Half a domain\"");
    v.choice("coordinates", s.coordinates, coordinates_names,
             "axisymmetric: x is the distance from the left edge");
  });
  v.map("grid", [&] {
    v.integer_or(
        "auto", "cells_x", s.cells_x,
        Key("", at_least(2), "square cells across the width; auto: chosen by `accuracy`; see \"Grid\""));
  });
  v.pair("gravity", s.gravity,
         Key("L/T^2", noted("two numbers"), "any direction")
             .required(si ? "in SI units, e.g. [0, -9.81]" : nullptr));
  v.choice("model", s.model, model_names,
           "mu_I is solved in time, the others are steady fields in closed form: [models.md](models.md)");
  v.module("kinematic", s.kinematic, [&](Kinematic& k) {
    v.number(
        "B", k.B,
        Key("L", above(0), "only for model kinematic, as the next two", "2 d is usual.").by_default("2 d"));
    v.number("Q", k.Q,
             Key("M/T", above(0), "discharge rate of all orifices of the whole silo",
                 "rho sqrt(g) W^1.5 is the default.")
                 .by_default("sum of rho sqrt(g) W^1.5"));
    v.choice("orifices", k.orifices, orifice_form_names, "as wide as they are, or all through their centres");
  });
  v.module("stochastic", s.stochastic, [&](Stochastic& k) {
    v.number(
        "L_s", k.L_s,
        Key("L", above(0), "size of a spot; only for model stochastic, as the next three", "4 d is usual.")
            .by_default("4 d"));
    v.number("Q", k.Q,
             Key("M/T", above(0), "as that of kinematic", "rho sqrt(g) W^1.5 is the default.")
                 .by_default("sum of rho sqrt(g) W^1.5"));
    v.choice("orifices", k.orifices, orifice_form_names, "as those of kinematic");
    v.number("spot", k.spot,
             Key("L", at_least(0), "the flow is averaged over this width along x", "0 does not average."));
  });
  v.module("radial", s.radial, [&](Radial& r) {
    v.number("phi", r.phi,
             Key("degrees", above(0).below(90), "internal friction; only for model radial, as the next four",
                 "It is asin(mu_s) of the material by default.")
                 .by_default("asin(mu_s)"));
    v.number("phi_w", r.phi_w,
             Key("degrees", noted("above 0, at most phi"), "wall friction").by_default("phi/2"));
    v.number("half_angle", r.half_angle,
             Key("degrees", above(0).below(90), "of the walls against the vertical",
                 "It is in degrees, against the vertical.")
                 .by_default("that of the hopper, else 90 - phi"));
    v.number("Q", r.Q,
             Key("M/T", above(0), "as that of kinematic", "rho sqrt(g) W^1.5 is the default.")
                 .by_default("rho sqrt(g) W^1.5, around an axis W^2.5"));
    v.choice("wall_angle", r.wall_angle, wall_angle_names, "what holds at the wall");
  });
  v.map("air", [&] {
    v.choice(
        "model", s.air.model, air_model_names,
        "passive: a thin, light fluid wherever there are no grains; none: p = 0 on the free surface, air "
        "is not solved");
    v.number("density", s.air.density,
             Key("M/L^2", above(0), "of the air", "Use 1e-3 of the grains' density.").times(of_density));
    v.number("viscosity", s.air.viscosity, Key("M/T", above(0), "of the air").times(of_viscosity));
  });
  v.named(
      "materials", s.materials, "at least one, e.g. sand: {mu_s: 0.62, delta_mu: 0.48, I_0: 0.6}",
      [&](Material& m) {
        v.number("mu_s", m.mu_s,
                 Key("1", at_least(0), "static friction", "Sand has about 0.4 to 0.6, glass beads 0.38."));
        v.number("delta_mu", m.delta_mu,
                 Key("1", at_least(0), "what friction gains at high inertial number; 0 is Coulomb",
                     "Glass beads have about 0.26."));
        v.number("I_0", m.I_0,
                 Key("1", above(0), "inertial number at which half of it is gained",
                     "Glass beads have about 0.28."));
        v.number("diameter", m.diameter,
                 Key("L", above(0), "of a grain", "It is 1 in grain units.")
                     .required(si ? "in SI units, e.g. 1e-3" : nullptr));
        v.number("density", m.density,
                 Key("M/L^2", above(0), "bulk density at rest", "It is 1 in grain units.")
                     .required(si ? "in SI units, e.g. 1500" : nullptr));
        v.number("cohesion", m.cohesion,
                 Key("M/T^2", at_least(0), "yield stress at zero pressure, added to mu P", "0 is dry sand."));
        v.number("viscosity", m.viscosity, Key("M/T", noted("> 0"), "only for law newtonian"));
        v.number("A", m.A,
                 Key("1", at_least(0), "only where the scene names the module, as the next two")
                     .by_default("that of `physics.nonlocal`"));
        v.number("phi_g", m.phi_g,
                 Key("1", at_least(0), "slope of phi(I)").by_default("that of `physics.dilatancy`"));
        v.number("F", m.F,
                 Key("1/L", at_least(0), "2 mu_w / gap").by_default("that of `physics.wall_friction`"));
      });
  v.module("start", s.start, [&](Start& start) {
    v.text("run", start.run,
           Key("", noted("a run folder"),
               "begin with a frame of a stored run; see \"Start from a stored run\""));
    v.number("time", start.time, Key("T", {}, "the frame nearest to it").by_default("the last frame"));
  });
  v.list("fill", s.fill,
         s.start
             ? nullptr
             : "what the domain holds at the start, e.g. - {material: sand, box: {x: [0, 150], y: [0, 135]}}",
         [&](Fill& f) {
           v.material("material", f.material, s.materials,
                      Key("", noted("a material, or air"), "what to paint with")
                          .required("the name of a material, or air"));
           v.shape(f.points, Key("L", noted("[a, b] with a < b"), "a fill has either a box"),
                   Key("L", noted("3 to 1000 corners in order, convex"), "or a polygon"));
         });
  if (s.left_is_middle()) s.walls[static_cast<int>(Side::left)] = Wall::free_slip;  // what a middle does
  v.map("walls", [&] {
    constexpr std::array about{"see \"Walls\"; free_slip in half a domain", "periodic: as the left one",
                               "periodic: only left and right", "periodic: only left and right"};
    for (std::size_t side = 0; side < 4; ++side)
      v.choice(side_names[side], s.walls[side], wall_names, about[side]);
  });
  v.list("orifices", s.orifices, nullptr, [&](Orifice& o) {
    v.choice("wall", o.wall, side_names, "a wall that is no_slip or free_slip");
    v.number("centre", o.centre,
             Key("L", noted("inside the wall"), "from the left or the bottom end of the wall")
                 .required("its place along the wall"));
    v.number("width", o.width,
             Key("L", above(0).also(">= 2 cells, better 8"), "two may touch, not overlap")
                 .required("its width, above 0"));
  });
  v.list("inserts", s.inserts, nullptr, [&](Insert& i) {
    if (v.choice("shape", i.shape, shape_names,
                 Key("a solid at rest in the flow; see \"Shapes\"").required("a word, e.g. circle")))
      visit_measures(v, i);
    else
      v.skip({"centre", "width", "height", "diameter", "points"});
  });
  v.module("hopper", s.hopper, [&](Hopper& h) {
    v.number("half_angle", h.half_angle,
             Key("degrees", above(0).below(90), "of the sloping walls against the vertical; see \"Hopper\"",
                 "It is in degrees, against the vertical.")
                 .required("of the walls against the vertical, in degrees, e.g. 30"));
    v.number("outlet", h.outlet,
             Key("L", noted("above 0, below the width"), "width of the outlet in the middle of the bottom")
                 .required("the width of the outlet, above 0"));
  });
  v.module("feed", s.feed, [&](Feed& f) {
    v.material("material", f.material, s.materials,
               Key("", noted("a material"), "grains of it replace air below the level: the silo stays filled")
                   .required("the name of a material"));
    v.number("level", f.level,
             Key("L", noted("above 0, at most the height"), "how far up the silo stays filled")
                 .required("the height up to which the domain is kept full, above 0"));
  });
  v.map("physics", [&] {
    v.map("rheology", [&] {
      Rheology& r = s.rheology;
      v.choice("law", r.law, law_names, "[physics.md](physics.md)");
      v.number("alpha", r.alpha,
               Key("1", above(0).below(2), "law mu_I_regularised: slope at small I", "1.9 is usual."));
      v.number("mu_inf", r.mu_inf,
               Key("1", at_least(0), "law mu_I_regularised: growth at large I", "0.05 is usual."));
      v.number("eta_min", r.eta_min,
               Key("M/T", above(0), "floor of the grains' viscosity").times(of_viscosity));
      v.number("eta_max", r.eta_max,
               Key("M/T", noted("> eta_min"), "cap, taken at rest").times(of_viscosity));
      v.choice("cap", r.cap, cap_names, "how the law meets eta_max");
      v.number("smoothing_length", r.smoothing_length,
               Key("L", at_least(0), "the shear rate is smoothed over this; 0: not at all",
                   "One grain diameter is the usual choice.")
                   .times(of_length));
      v.choice("corner_mean", r.corner_mean, corner_mean_names,
               "mean that takes the viscosity to cell corners");
      v.choice("orifice_edge", r.orifice_edge, edge_rule_names,
               "shear at a corner where wall and orifice meet");
      v.number("background_pressure", r.background_pressure,
               Key("M/T^2", at_least(0), "added to p in mu(I); for verification flows"));
    });
    v.module("nonlocal", s.nonlocal, [&](Nonlocal& n) {
      v.number("A", n.A, Key("1", at_least(0), "nonlocal amplitude; see \"Modules\"", "0.5 is usual."));
      v.choice("closure", n.closure, closure_names, "what spreads the fluidity");
      v.choice("walls", n.walls, fluidity_wall_names, "granular fluidity at walls");
    });
    v.module("dilatancy", s.dilatancy, [&](Dilatancy& d) {
      v.number("phi_g", d.phi_g, Key("1", at_least(0), "slope of phi(I)", "0.2 is usual."));
      v.number("phi_max", d.phi_max, Key("1", above(0).at_most(1), "packing at rest", "0.6 is usual."));
      v.number("phi_min", d.phi_min, Key("1", noted("above 0, at most phi_max"), "least packing"));
      v.choice("mode", d.mode, dilatancy_mode_names, "what follows from phi(I)");
      v.number("relaxation_time", d.relaxation_time,
               Key("T", above(0), "mode source", "sqrt(d/g) is the default.").times(of_time));
      v.number("K", d.K, Key("1", above(0), "mode relax", "4 is usual."));
    });
    v.module("wall_friction", s.wall_friction, [&](WallFriction& f) {
      v.number("F", f.F, Key("1/L", at_least(0), "2 mu_w / gap"));
      v.number("mu_w", f.mu_w, Key("1", at_least(0), "F, or this and gap"));
      v.number("gap", f.gap, Key("L", above(0), "distance of front and back wall"));
      v.choice("mode", f.mode, friction_mode_names,
               "in the viscous solve, or as the thesis's explicit limiter");
      v.number("speed_floor", f.speed_floor,
               Key("L/T", above(0), "below it friction is a drag", "1e-5 sqrt(g d) is the default.")
                   .times(of_speed));
      v.pair("wall_velocity", f.wall_velocity, Key("L/T", noted("two numbers"), "of front and back wall"));
    });
  });
  v.map("time", [&] {
    v.number("end", s.time.end, Key("T", at_least(0), "when the run ends; 0: no limit", "0 sets no limit."));
    v.number("cfl", s.time.cfl,
             Key("1", above(0).at_most(0.5), "largest speed near grains, times step, over cell",
                 "Beyond 0.5 the volume of grains would not be kept."));
    v.number("dt_max", s.time.dt_max,
             Key("T", above(0), "longest step", "0.0548 sqrt(d/g) is the default.").times(of_time));
    v.integer("max_steps", s.time.max_steps,
              Key("", at_least(0), "when it ends at the latest; 0: no limit", "0 sets no limit."));
    v.choice("start_pressure", s.start_pressure, start_pressure_names,
             "zero lets an orifice flow at once; hydrostatic keeps a closed tank still");
  });
  v.map("stop", [&] {
    v.number("mass_below", s.stop.mass_below,
             Key("1", above(0).below(1), "fraction of the initial grain mass").by_default("no such stop"));
    v.number("steady_discharge", s.stop.steady_discharge,
             Key("1", above(0).below(1), "relative change of the discharge rate").by_default("no such stop"));
  });
  int preset = -1;
  if (v.word("accuracy", preset, accuracy_names)) {
    if (preset >= 0) s.accuracy = accuracy_presets[preset];
  } else {
    v.map("accuracy", [&] {
      Accuracy& a = s.accuracy;
      v.preset("preset", a, accuracy_names, accuracy_presets,
               Key("what the other keys under `accuracy` start from; see below").by_default("balanced"));
      v.number("viscous_tolerance", a.viscous_tolerance,
               Key("1", above(0).below(1), "error over flow, in the energy norm", "1e-3 is balanced."));
      v.number("pressure_tolerance", a.pressure_tolerance,
               Key("1", above(0).below(1), "largest divergence times step", "3e-6 is balanced."));
      v.number("fluidity_tolerance", a.fluidity_tolerance,
               Key("1", above(0).below(1), "error of the granular fluidity over its own size, everywhere",
                   "1e-2 is balanced."));
      v.integer("max_iterations", a.max_iterations, Key("", at_least(1), "of each solve"));
      v.integer("extra_sweeps", a.extra_sweeps,
                Key("", within(0, 8),
                    "more sweeps of the smoothers on every level of a V-cycle: fewer, dearer iterations"));
      v.integer("backup_every", a.backup_every,
                Key("", at_least(0),
                    "steps between states kept to go back to in trouble ([theory.md](theory.md)); costs the "
                    "memory of the fields and under 1 % of the time; 0: never",
                    "0 keeps none."));
      v.choice("precision", a.precision, precision_names, "float or double inside the preconditioner");
      v.choice("solids", a.solids, solid_model_names,
               "how solids meet the grid: by the shares of faces and cells that they leave open, or cell by "
               "cell");
      v.choice("vof", a.vof, vof_flux_names,
               "what leaves a cell: what its interface says, or a share of all that is in it; "
               "[accuracy.md](accuracy.md), \"Advection of materials\"");
      v.number("step_factor", a.step_factor,
               Key("1", above(0).at_most(100), "on `time.dt_max`", "It multiplies time.dt_max."));
      v.integer("cells_across_orifice", a.cells_across_orifice,
                Key("", within(2, 1024),
                    "cells across the narrowest orifice, where `grid.cells_x` is not given; see \"Grid\"",
                    "16 is balanced."));
      v.integer("extrapolate", a.extrapolate,
                Key("", within(0, 2),
                    "coarser grids that the scene is run on too, to extrapolate its discharge; see "
                    "\"Extrapolation\"",
                    "0 extrapolates nothing."));
      v.map("splitting", [&] {
        v.integer("outer", a.splitting.outer,
                  Key("", within(1, 100),
                      "rounds of viscous solve and projection a step ([theory.md](theory.md))"));
        v.integer("picard", a.splitting.picard,
                  Key("", within(1, 100), "viscous solves a round, each with a new viscosity"));
        v.number("rotational", a.splitting.rotational,
                 Key("1", at_least(0).below(2), "omega of the rotational pressure update",
                     "1 is the usual form."));
      });
    });
  }
  v.map("output", [&] {
    v.number("series_every", s.output.series_every, Key("T", above(0), "a row of series.csv").times(of_time));
    v.number("fields_every", s.output.fields_every,
             Key("T", at_least(0), "a frame of fields.h5; 0: none", "0 stores no fields.").times(of_time));
    v.number("snapshots_every", s.output.snapshots_every,
             Key("T", at_least(0), "a set of pictures; 0: none", "0 draws no pictures.").times(of_time));
    v.texts("fields", s.output.fields,
            "stored and drawn where the scene has them, some with a module only: [output.md](output.md)");
    v.number(
        "checkpoint_minutes", s.output.checkpoint_minutes,
        Key("min", within(0, 1e6),
            "wall time between checkpoints ([output.md](output.md), Resume); 0: only where the run ends or "
            "a signal stops it",
            "0 writes a checkpoint only where the run ends or a signal stops it."));
    v.integer(
        "compression", s.output.compression,
        Key("", within(0, 9),
            "of fields.h5: level of deflate, behind a shuffle of bytes; price in [output.md](output.md)",
            "0 does not compress."));
  });
  v.integer("threads", s.threads,
            Key("", within(0, 1024), "0: as many as there are cores to run on", "0 takes all cores."));
}

}  // namespace hourglass
