#pragma once
// Jenike's radial stress and velocity fields in a hopper of grains that yield everywhere (Jenike 1964;
// Nedderman 1992). Polar coordinates from the apex of the walls, theta from the vertical; compression is
// positive. With p the mean of the major and the minor stress and psi the angle from the radius to the major
// one,
//   p = rho g r q(theta),  S = sin(phi),
//   sigma_rr = p (1 + S cos 2psi),  sigma_tt = p (1 - S cos 2psi),  tau_rt = p S sin 2psi
// and in a cone sigma_cc = p (1 + S). Equilibrium is A q' + B psi' + C = 0, D q' + E psi' + F = 0 with
//   A = S sin 2psi,  B = 2 q S cos 2psi,  D = 1 - S cos 2psi,  E = 2 q S sin 2psi,
//   cone   C = cos theta + q [1 - S + S (4 cos 2psi + sin 2psi cot theta)],
//          F = q S [4 sin 2psi - (1 + cos 2psi) cot theta] - sin theta
//   wedge  C = cos theta + q (1 + 3 S cos 2psi),  F = 3 q S sin 2psi - sin theta.
// psi = pi/2 on the axis; at the wall the friction angle phi_w sets psi; q on the axis is found by shooting.
// Coaxial, radial flow without change of volume: v_r = -f/r^m, f = f_0 exp(-(m + 1) int tan 2psi dtheta), m =
// 2 in a cone, 1 in a wedge. f_0 follows from the discharge.
#include <array>
#include <optional>
#include <vector>

namespace hourglass {

/// What psi is at the wall: by the friction of the wall, pi/2 + [phi_w + asin(sin phi_w / sin phi)] / 2, or
/// the pi/2 - phi_w of the reference thesis, which turns the shear stress round: only to compare with its
/// figures.
enum class WallAngle { friction, thesis };

struct RadialHopper {
  double phi = 0;         ///< angle of internal friction [rad], above 0, below pi/2
  double phi_w = 0;       ///< angle of wall friction [rad], above 0, at most phi
  double half_angle = 0;  ///< of the walls against the vertical [rad], above 0, below pi/2
  bool cone = false;      ///< else a wedge
  WallAngle wall = WallAngle::friction;

  double psi_wall() const;  ///< [rad]
};

class RadialField {
 public:
  struct Point {
    double q = 0;    ///< stress [1]
    double psi = 0;  ///< [rad]
    double f = 0;    ///< speed over that on the axis at the same radius [1]
  };
  /// 0 <= theta <= half_angle [rad]; error below 1e-10.
  Point at(double theta) const;
  double q_axis() const { return nodes_.front().y[0]; }
  /// Flux over f_0: 2 int f dtheta in a wedge, per unit depth; 2 pi int f sin theta dtheta in a cone [1].
  double flux() const;

 private:
  friend std::optional<RadialField> radial_field(const RadialHopper& hopper);
  struct Node {
    std::array<double, 3> y, slope;  // q, psi, ln f
  };
  RadialHopper hopper_;
  std::vector<Node> nodes_;  // evenly over theta
};

/// psi at the wall less what it has to be there [rad], for a stress q_axis > 0 on the axis; nullopt if the
/// solution ends at a singular point before the wall.
std::optional<double> shooting_error(const RadialHopper& hopper, double q_axis);

/// The field with the largest stress on the axis that meets the wall; nullopt beyond the mass-flow limit,
/// where there is none, or where shear would stop the flow inside of the hopper (psi = 3 pi/4).
std::optional<RadialField> radial_field(const RadialHopper& hopper);

/// The largest half-angle that has a field [rad], for these angles of friction: beyond it the hopper does not
/// flow along its walls (mass-flow limit). hopper.half_angle is not read. To 1e-4.
double mass_flow_limit(RadialHopper hopper);

}  // namespace hourglass
