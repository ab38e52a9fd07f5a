#pragma once
// A scene: what is to be solved, as plain structs with units and defaults. Files are io's business
// (io/scene_yaml); the solver and its tests build a Scene in C++. Dimensions stand in brackets: L length,
// T time, M mass per unit depth; any consistent system does (grain units: d = g = rho = 1, or SI).
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "kernels/granular_laws.hpp"
#include "kernels/patch.hpp"
#include "solver/models/radial.hpp"

namespace hourglass {

// Each enum is followed by the words that scene files and messages use for it, in its order.
enum class Units { grain, SI };
inline constexpr std::array units_names{"grain", "SI"};
enum class Side { left, right, bottom, top };
inline constexpr std::array side_names{"left", "right", "bottom", "top"};
/// What a side of the domain does where no orifice pierces it. `open`: p = 0 and no traction, flow in or out.
/// `periodic` comes in the pair left, right.
enum class Wall { no_slip, free_slip, open, periodic };
inline constexpr std::array wall_names{"no_slip", "free_slip", "open", "periodic"};
/// What answers: mu_I solves the flow in time; the others are steady fields in closed form (docs/models.md).
enum class Model { mu_I, kinematic, stochastic, radial };
inline constexpr std::array model_names{"mu_I", "kinematic", "stochastic", "radial"};
/// Orifices of the models kinematic and stochastic: as wide as they are, or all flow through their centres.
enum class OrificeForm { slot, point };
inline constexpr std::array orifice_form_names{"slot", "point"};
enum class Law { mu_I, mu_I_regularised, newtonian };
inline constexpr std::array law_names{"mu_I", "mu_I_regularised", "newtonian"};
/// How the viscosity of slow grains meets eta_max: cut off there, or smoothly, by adding (mu_s P / eta_max)^2 to
/// |γ̇|^2.
enum class Cap { clip, smooth };
inline constexpr std::array cap_names{"clip", "smooth"};
/// What spreads the granular fluidity: docs/physics.md, Nonlocal fluidity.
enum class Closure { thesis, kamrin };
inline constexpr std::array closure_names{"thesis", "kamrin"};
/// Granular fluidity at walls.
enum class FluidityWall { zero, no_flux };
inline constexpr std::array fluidity_wall_names{"zero", "no_flux"};
/// What follows from the packing fraction phi(I): docs/physics.md, Dilatancy.
enum class DilatancyMode { source, relax, weight };
inline constexpr std::array dilatancy_mode_names{"source", "relax", "weight"};
/// Wall friction in the viscous solve, or as the thesis's explicit limiter.
enum class FrictionMode { implicit, limiter };
inline constexpr std::array friction_mode_names{"implicit", "limiter"};
/// Mean that takes the viscosity from the four cells around a corner to the corner.
enum class CornerMean { harmonic, arithmetic };
inline constexpr std::array corner_mean_names{"harmonic", "arithmetic"};
/// Weight of the shear at a corner where a wall ends and an orifice begins, in units of a free corner's
/// (a full wall corner has 2): docs/accuracy.md, "The two corners of an orifice".
enum class EdgeRule { half_wall, free, wall };
inline constexpr std::array edge_rule_names{"half_wall", "free", "wall"};
/// Pressure at the start: zero lets an orifice flow at once (docs/theory.md, Start); hydrostatic holds a
/// closed tank still.
enum class StartPressure { zero, hydrostatic };
inline constexpr std::array start_pressure_names{"zero", "hydrostatic"};
/// What holds at the wall of the radial model: solver/models/radial.hpp.
inline constexpr std::array wall_angle_names{"friction", "thesis"};
/// Precision inside the preconditioner and the Krylov directions; unknowns and residuals are always double.
enum class Precision { mixed, full };
inline constexpr std::array precision_names{"mixed", "full"};

/// What of a cell leaves through a face: what lies there, by the interface reconstructed in the cell (second order), or
/// the share of each material in the whole cell (first order).
enum class VofFlux { plic, upwind };
inline constexpr std::array vof_flux_names{"plic", "upwind"};

/// Solids in the flow; width and height are those of the bounding box, `centre` its middle.
enum class Shape { square, rectangle, diamond, triangle_up, triangle_down, circle, polygon };
inline constexpr std::array shape_names{"square",        "rectangle", "diamond", "triangle_up",
                                        "triangle_down", "circle",    "polygon"};
/// mirror: the left edge is a mirror plane, the domain one half of what is meant.
enum class Symmetry { none, mirror };
inline constexpr std::array symmetry_names{"none", "mirror"};
/// axisymmetric: x is the distance from the axis, which is the left edge.
enum class Coordinates { cartesian, axisymmetric };
inline constexpr std::array coordinates_names{"cartesian", "axisymmetric"};
/// none: p = 0 on the free surface, air is not solved.
enum class AirModel { passive, none };
inline constexpr std::array air_model_names{"passive", "none"};
/// How solids meet the grid: by the shares of faces and cells that they leave open, or cell by cell.
enum class SolidModel { cut_cells, staircase };
inline constexpr std::array solid_model_names{"cut_cells", "staircase"};

struct Material {
  std::string name = "sand";
  double mu_s = 0.62;      ///< static friction [1] >= 0
  double delta_mu = 0.48;  ///< mu at I -> infinity less mu_s [1] >= 0
  double I_0 = 0.6;        ///< [1] > 0
  double diameter = 1;     ///< grain diameter [L] > 0
  double density = 1;      ///< bulk density at rest [M/L^2] > 0
  double cohesion = 0;     ///< yield stress at P = 0, added to mu P [M/T^2] >= 0
  double viscosity = 0;    ///< only for law newtonian: eta [M/T] > 0
  // Its own value where it differs from that of the module; only where the scene names the module.
  std::optional<double> A{};      ///< physics.nonlocal.A [1] >= 0
  std::optional<double> phi_g{};  ///< physics.dilatancy.phi_g [1] >= 0
  std::optional<double> F{};      ///< physics.wall_friction.F [1/L] >= 0
  bool operator==(const Material&) const = default;
};

/// A box or a polygon painted with a material; later ones paint over earlier ones.
struct Fill {
  int material = 0;                           ///< index into Scene::materials; -1 paints air
  std::vector<std::array<double, 2>> points;  ///< corners in order [L]; convex
  bool operator==(const Fill&) const = default;
};

struct Orifice {
  Side wall = Side::bottom;
  double centre = 75;    ///< along the wall [L]
  double width = 18.75;  ///< [L] > 0
  bool operator==(const Orifice&) const = default;
};

/// A solid at rest, without slip.
struct Insert {
  Shape shape = Shape::circle;
  std::array<double, 2> centre{0, 0};         ///< [L]; not of a polygon
  double width = 0, height = 0;               ///< [L] > 0; a square's and a circle's height is their width
  std::vector<std::array<double, 2>> points;  ///< corners of a polygon in order [L]
  bool operator==(const Insert&) const = default;
};

/// Sloping walls from the sides of the domain down to an outlet in the middle of its bottom.
struct Hopper {
  double half_angle = 30;  ///< of the walls against the vertical [degrees], above 0, below 90
  double outlet =
      18.75;  ///< width of the outlet [L] > 0; an orifice of this width, if the scene names none at the bottom
  bool operator==(const Hopper&) const = default;
};

/// Grains of this material replace air below the level, so that the silo stays filled.
struct Feed {
  int material = 0;  ///< index into Scene::materials
  double level = 0;  ///< y [L]
  bool operator==(const Feed&) const = default;
};

/// Begin with a frame of a stored run of the same domain, on any grid, instead of the fills.
struct Start {
  std::string run;               ///< its folder
  std::optional<double> time{};  ///< of the frame nearest to it [T]; nullopt: the last frame
  bool operator==(const Start&) const = default;
};

struct Air {
  double density = 1e-3;      ///< [M/L^2] > 0
  double viscosity = 0.0164;  ///< eta [M/T] > 0
  AirModel model = AirModel::passive;
  bool operator==(const Air&) const = default;
};

struct Rheology {
  Law law = Law::mu_I;
  double eta_min = 1;             ///< floor of the grains' viscosity [M/T]; rho d sqrt(g d)
  double eta_max = 1.643e6;       ///< cap, taken at rest [M/T]
  double smoothing_length = 0.5;  ///< the shear rate is smoothed over this [L]; 0: not at all
  Cap cap = Cap::clip;
  double alpha = 1.9;    ///< law mu_I_regularised: slope of its logarithmic branch [1] in (0, 2)
  double mu_inf = 0.05;  ///< the same: growth of mu at large I [1] >= 0
  CornerMean corner_mean = CornerMean::harmonic;
  EdgeRule orifice_edge = EdgeRule::half_wall;
  double background_pressure = 0;  ///< added to p in mu(I) and I [M/T^2]; for verification flows
  bool operator==(const Rheology&) const = default;
};

/// Granular fluidity g = P/eta spread over neighbours: g = g_local + xi^2 lap g, xi = A d sqrt(...).
struct Nonlocal {
  double A = 0.5;  ///< nonlocal amplitude [1] >= 0
  Closure closure = Closure::thesis;
  FluidityWall walls = FluidityWall::zero;
  bool operator==(const Nonlocal&) const = default;
};

/// Packing fraction phi(I) = max(phi_max - phi_g I, phi_min).
struct Dilatancy {
  double phi_g = 0.2;  ///< [1] >= 0
  double phi_max = 0.6, phi_min = 0.2;
  DilatancyMode mode = DilatancyMode::source;
  double relaxation_time = 1;  ///< mode source: phi reaches phi(I) in this time [T] > 0
  double K = 4;                ///< mode relax: div u = K |γ̇| (phi - phi(I)) [1] > 0
  bool operator==(const Dilatancy&) const = default;
};

/// Friction of a front and a back wall (Hele-Shaw): a force F P against the motion.
struct WallFriction {
  std::optional<double> F{};     ///< 2 mu_w / gap [1/L] >= 0
  std::optional<double> mu_w{};  ///< or by friction [1] ...
  std::optional<double> gap{};   ///< ... and distance of the walls [L]
  FrictionMode mode = FrictionMode::implicit;
  double speed_floor = 1e-5;                  ///< below it friction is a drag, F P u / speed_floor [L/T] > 0
  std::array<double, 2> wall_velocity{0, 0};  ///< of the two walls [L/T]

  double strength() const { return F ? *F : mu_w && gap ? 2 * *mu_w / *gap : 0; }
  bool operator==(const WallFriction&) const = default;
};

// Parameters of the models that are fields in closed form. What is not given here resolve_model() fills in.

/// solver/models/kinematic.hpp
struct Kinematic {
  std::optional<double> B{};  ///< [L] > 0; 2 d
  std::optional<double>
      Q{};  ///< discharge rate of all orifices of the whole silo [M/T] > 0; discharge_scale() of each
  OrificeForm orifices = OrificeForm::slot;
  bool operator==(const Kinematic&) const = default;
};

/// solver/models/stochastic.hpp
struct Stochastic {
  std::optional<double> L_s{};  ///< size of a spot [L] > 0; 4 d
  std::optional<double> Q{};    ///< as above
  OrificeForm orifices = OrificeForm::slot;
  double spot = 0;  ///< width over which the flow is averaged along x [L] >= 0
  bool operator==(const Stochastic&) const = default;
};

/// solver/models/radial.hpp; angles in degrees. A wedge, around an axis a cone.
struct Radial {
  std::optional<double> phi{};    ///< of internal friction, above 0, below 90; asin(mu_s)
  std::optional<double> phi_w{};  ///< of wall friction, above 0, at most phi; phi/2
  std::optional<double>
      half_angle{};           ///< of the walls against the vertical; that of the hopper, or without one the
                              ///< slope of the angle of repose, 90 - phi
  std::optional<double> Q{};  ///< as above
  WallAngle wall_angle = WallAngle::friction;
  bool operator==(const Radial&) const = default;
};

struct TimeControl {
  double end = 0;          ///< [T]; 0: no limit by time
  double cfl = 0.5;        ///< max |u| dt / h near grains, in (0, 0.5]
  double dt_max = 0.0548;  ///< [T] > 0
  long max_steps = 0;      ///< 0: no limit by steps
  bool operator==(const TimeControl&) const = default;
};

struct Stop {
  std::optional<double> mass_below;        ///< fraction of the initial grain mass
  std::optional<double> steady_discharge;  ///< relative change of the discharge rate over its own window
  bool operator==(const Stop&) const = default;
};

/// How a step couples velocity, pressure and viscosity (docs/theory.md, Splitting).
struct Splitting {
  int outer = 1;          ///< rounds of viscous solve and projection a step
  int picard = 1;         ///< viscous solves a round, each with the viscosity of the velocity before
  double rotational = 1;  ///< omega in p += δp - omega eta div u** [1] in [0, 2): docs/theory.md, Splitting
  bool operator==(const Splitting&) const = default;
};

/// The levers that trade speed for accuracy; `accuracy:` in a scene file.
struct Accuracy {
  double viscous_tolerance = 1e-3;   ///< energy norm of the error over that of the flow
  double pressure_tolerance = 3e-6;  ///< max |div u| dt
  double fluidity_tolerance = 1e-2;  ///< error of the granular fluidity over its own size, everywhere
  int max_iterations = 200;
  int extra_sweeps = 0;   ///< more sweeps of the smoothers on every level of a V-cycle
  int backup_every = 16;  ///< steps from one state to go back to to the next; 0: none is kept
  Precision precision = Precision::mixed;
  SolidModel solids = SolidModel::cut_cells;
  VofFlux vof = VofFlux::plic;
  double step_factor = 1;         ///< on TimeControl::dt_max
  int cells_across_orifice = 16;  ///< at least, where nobody says how many cells: default_cells()
  /// On so many coarser grids, each of half the cells across, the scene is run too and its figures of merit are
  /// extrapolated (studies/extrapolation). 0 to 2.
  int extrapolate = 0;
  Splitting splitting{};
  bool operator==(const Accuracy&) const = default;
};

struct Output {
  double series_every = 0.27;     ///< [T]
  double fields_every = 5.48;     ///< [T]; 0: none
  double snapshots_every = 5.48;  ///< [T]; 0: none
  std::vector<std::string> fields{"speed",  "pressure",       "grains",
                                  "tracer", "fluidity_ratio", "packing"};  ///< those that the scene has
  double checkpoint_minutes = 10;  ///< of wall time between states to resume from; 0: only at the run's end
  int compression = 0;             ///< of fields.h5: level of deflate, 0 (none) to 9
  bool operator==(const Output&) const = default;
};

struct Scene {
  std::string name = "silo";
  Units units = Units::grain;
  double width = 150, height = 150;  ///< [L]
  Symmetry symmetry = Symmetry::none;
  Coordinates coordinates = Coordinates::cartesian;
  int cells_x = 128;                     ///< square cells: cells_y = cells_x height / width
  std::array<double, 2> gravity{0, -1};  ///< [L/T^2]
  Model model = Model::mu_I;
  std::optional<Kinematic> kinematic;  ///< these three each for the model of its name
  std::optional<Stochastic> stochastic;
  std::optional<Radial> radial;
  Air air;
  std::vector<Material> materials{Material{}};
  std::vector<Fill> fill;  ///< not read with a start
  std::array<Wall, 4> walls{Wall::no_slip, Wall::no_slip, Wall::no_slip, Wall::open};  ///< by Side
  std::vector<Orifice> orifices;
  std::vector<Insert> inserts;
  std::optional<Hopper> hopper;
  std::optional<Feed> feed;
  std::optional<Start> start;
  Rheology rheology;
  std::optional<Nonlocal> nonlocal;  ///< what is not named is not modelled, not stored, not paid for
  std::optional<Dilatancy> dilatancy;
  std::optional<WallFriction> wall_friction;
  TimeControl time;
  Stop stop;
  Accuracy accuracy;
  Output output;
  StartPressure start_pressure = StartPressure::zero;
  int threads = 0;  ///< 0: as many as there are cores to run on

  Wall wall(Side s) const { return walls[static_cast<int>(s)]; }
  bool axisymmetric() const { return coordinates == Coordinates::axisymmetric; }
  /// The left edge is not a wall but the middle of what is meant.
  bool left_is_middle() const { return symmetry == Symmetry::mirror || axisymmetric(); }
  /// What a unit of the domain's area, with axisymmetric coordinates weighted by r/width, stands for in the whole silo:
  /// 2 with its mirror image, 2 pi width [L] around an axis.
  double copies() const { return axisymmetric() ? 2 * M_PI * width : symmetry == Symmetry::mirror ? 2 : 1; }
  double g() const { return std::hypot(gravity[0], gravity[1]); }  ///< [L/T^2]
  Patch patch() const;                                             ///< the whole domain; cells_y rounded
  bool operator==(const Scene&) const = default;
};

/// What dimensional defaults are multiples of, from the first material and g = |gravity|. A default above is
/// the multiple itself, which is right as it stands in grain units.
struct Scales {
  double length = 1;     ///< d [L]
  double time = 1;       ///< sqrt(d/g) [T]
  double density = 1;    ///< rho [M/L^2]
  double viscosity = 1;  ///< rho sqrt(g d^3) [M/T]
  double speed = 1;      ///< sqrt(g d) [L/T]
};
Scales scales(const Scene& scene);

/// What the law needs of a material.
Grain grain_of(const Material& material);

/// The inertial numbers [low, high] between which the mu(I) equations of a material are well posed; nullopt
/// if there are none (granular_laws.hpp, well_posedness).
std::optional<std::array<double, 2>> well_posed_range(const Material& material);

/// The law mu_I_regularised of a material; nullopt where mu(I) is well posed nowhere: then it has no I_1 to hold on to.
std::optional<RegularisedFriction> regularised_friction(const Material& material, const Rheology& rheology);

/// The grid that accuracy.cells_across_orifice asks for: cells across the width.
struct DefaultCells {
  int cells_x = 0;       ///< 0: none near has a whole height and coarsens
  bool fewer = false;    ///< than asked for: `most_default_cells`
  double narrowest = 0;  ///< width of the narrowest orifice [L]; 0: there is none
};
inline constexpr int most_default_cells = 1024;
/// Enough cells for the narrowest orifice, 8 times as many across the width where there is none; a multiple of 16, so
/// that the multigrid coarsens well, where the height allows it.
DefaultCells default_cells(const Scene& scene);

/// The scene on a grid with half the cells across, `halvings` times; alone: it asks for no extrapolation.
Scene coarser(const Scene& scene, int halvings);

/// A thing wrong with a scene: the dotted path of the key, what is wrong with allowed range and cure.
struct Problem {
  std::string path;     ///< e.g. "materials.sand.mu_s", "orifices.0.width"
  std::string message;  ///< e.g. "-0.1 is out of range: must be >= 0; ..."
  bool fatal = true;    ///< false: a warning, the scene runs all the same
};

/// Everything that is wrong or doubtful, all at once; empty for a clean scene. Reads no files.
std::vector<Problem> check(const Scene& scene);

}  // namespace hourglass
